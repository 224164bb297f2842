// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/msg/largest_sample.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "common/bus/message_cdr.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/msg/imu.hpp"

namespace rtd::bus {
namespace {

using msg::largest_sample;

template <class... T>
std::set<std::string> names_of(TypeList<T...>) {
  return {msg::type_name(msg::TypeOf<T>())...};
}

TEST(LargestSamples, are_listed_for_types_of_the_bus_alone) {
  const std::set<std::string> known = names_of(MessageTypes());
  for (const msg::SampleLimit& limit : msg::kLargestSamples) {
    EXPECT_TRUE(known.contains(std::string(limit.type))) << limit.type;
    EXPECT_GT(limit.bytes, msg::kLargestSmallSample) << limit.type;
    EXPECT_LE(limit.bytes, msg::kLargestOfOthers) << limit.type;
  }
}

TEST(LargestSamples, of_fixed_size_are_as_large_as_they_are) {
  EXPECT_EQ(largest_sample<msg::FeatureFrame>(), 4 + sizeof(msg::FeatureFrame));
  EXPECT_LE(largest_sample<msg::FeatureFrame>(), 2 * msg::kMib);
  EXPECT_EQ(largest_sample<msg::RgbdFrame1920>(), 4 + sizeof(msg::RgbdFrame1920));
  EXPECT_LE(largest_sample<msg::RgbdFrame1920>(), 12 * msg::kMib);
}

/// A message of ours is never larger than what its settings allow (docs/topics.md).
template <class T>
void expect_room_for(const T& message) {
  EXPECT_LE(cdr_size(message), largest_sample<T>()) << msg::type_name(msg::TypeOf<T>());
}

TEST(LargestSamples, have_room_for_the_largest_messages_of_ours) {
  const msg::Header header{{}, std::string(100, 'f')};
  expect_room_for(msg::OccupancyGrid{.header = header, .data = std::vector<std::int8_t>(16'000'000)});  // max_cells
  msg::PointCloud2 cloud{.header = header};
  cloud.fields.resize(4, {.name = "intensity"});
  cloud.data.resize(1'000'000 * 16);  // a large map
  expect_room_for(cloud);
  constexpr std::size_t kCell = 4;
  expect_room_for(msg::Image{
      .header = header, .encoding = "mono8", .data = std::vector<std::uint8_t>(1920 / kCell * 1200 / kCell)});
  msg::Detection2DArray detections{header, {}};  // detector.max_detections
  detections.detections.resize(1000, {.header = header, .results = std::vector<msg::ObjectHypothesisWithPose>(1)});
  expect_room_for(detections);
  expect_room_for(msg::CameraInfo{.header = header, .distortion_model = "plumb_bob", .d = std::vector<double>(64)});
  expect_room_for(msg::Odometry{.header = header, .child_frame_id = header.frame_id});
  msg::ServiceStatus status{.service = std::string(64, 's'), .message = std::string(4096, 'm')};
  status.metrics.resize(500, {std::string(80, 'n'), 1.0});
  expect_room_for(status);
}

RawTopic topic(const std::string& name, const std::string& type) {
  return {name, type};
}

TEST(LargestSamples, are_those_of_the_table_on_topics_of_ours) {
  const std::string cloud = "sensor_msgs::msg::dds_::PointCloud2_", image = "sensor_msgs::msg::dds_::Image_";
  EXPECT_EQ(bus::largest_sample(topic("rt/slam/map_points", cloud)), 16 * msg::kMib);
  EXPECT_EQ(bus::largest_sample(topic("rt/anna/slam/map_points", cloud)), 16 * msg::kMib) << "of a robot";
  EXPECT_EQ(bus::largest_sample(topic("rt/filter/dynamic_mask", image)), msg::kMib);
  EXPECT_EQ(bus::largest_sample(topic("rtd/status", "rtd_msgs::msg::dds_::ServiceStatus_")), msg::kLargestSmallSample);
  EXPECT_EQ(bus::largest_sample(topic("rtd/features", "rtd_msgs::msg::dds_::FeatureFrame_")),
            largest_sample<msg::FeatureFrame>());
}

TEST(LargestSamples, of_other_programs_may_be_large_where_their_type_may) {
  EXPECT_EQ(bus::largest_sample(topic("rt/lidar", "sensor_msgs::msg::dds_::PointCloud2_")), msg::kLargestOfOthers);
  EXPECT_EQ(bus::largest_sample(topic("rt/x", "my_msgs::msg::dds_::X_")), msg::kLargestOfOthers);
  EXPECT_EQ(bus::largest_sample(topic("rt/slam/path", "my_msgs::msg::dds_::X_")), msg::kLargestOfOthers);
  EXPECT_EQ(bus::largest_sample(topic("rt/imu", msg::kImuDdsType)), msg::kLargestSmallSample);
  EXPECT_EQ(bus::largest_sample(topic("rt/wheels", msg::kOdometryDdsType)), msg::kLargestSmallSample);
}

}  // namespace
}  // namespace rtd::bus
