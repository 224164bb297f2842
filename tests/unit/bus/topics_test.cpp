// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/frame_topics.hpp"
#include "common/bus/message_cdr.hpp"
#include "common/bus/offered_qos.hpp"
#include "common/bus/qos.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/bus/topics.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/largest_sample.hpp"
#include "tests/support/inprocess/domain.hpp"

namespace rtd::bus {
namespace {

using msg::largest_sample;

struct TopicFacts {
  std::string name;
  MessageId type;
  QosProfile profile;
  bool plain;
};

template <class T>
TopicFacts facts(const Topic<T>& topic) {
  return {topic.name, MessageTraits<T>::kId, topic.profile, MessageTraits<T>::kPlain};
}

std::vector<TopicFacts> all_topics() {
  using namespace topics;
  return {facts(kFrame),
          facts(kFeatures),
          facts(kKeyframes),
          facts(kTracking),
          facts(kStatus),
          facts(kColorJpeg),
          facts(kCameraInfo),
          facts(kDetections),
          facts(kOdometry),
          facts(kPose),
          facts(kTf),
          facts(kPath),
          facts(kMapPoints),
          facts(kDiagnostics),
          facts(kDynamicMask),
          facts(kDensePoints),
          facts(kMap),
          facts(kMovers),
          facts(kGroundTruth),
          facts(kMoverBoxes),
          facts(kMoverMarkers),
          facts(kTfStatic),
          facts(kOccupancyGrid),
          facts(kPersonMasks),
          facts(kMapJumps),
          facts(kDepthJpeg),
          facts(kKeyframeFeatures),
          facts(kKeyframeRequest),
          facts(kSubmap),
          facts(kAtlas),
          facts(kAtlasRobots),
          facts(kAtlasPoints),
          facts(kAtlasFloorPlan),
          facts(kAtlasMapJumps)};
}

TEST(Topics, have_names_of_their_own) {
  std::set<std::string> names;
  for (const TopicFacts& topic : all_topics()) EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
}

TEST(Topics, standard_types_go_where_ros2_looks_and_our_own_do_not) {
  for (const TopicFacts& topic : all_topics()) {
    const bool own_type = visit_message_type(topic.type, []<class T>() {
      return std::string_view(msg::type_name(msg::TypeOf<T>())).starts_with("rtd_msgs/");
    });
    EXPECT_EQ(topic.name.rfind("rt/", 0) == 0, !own_type) << topic.name;
  }
}

TEST(Topics, every_message_type_is_reachable_by_its_id) {
  for (const TopicFacts& topic : all_topics()) {
    const MessageId visited = visit_message_type(topic.type, []<class T>() { return MessageTraits<T>::kId; });
    EXPECT_EQ(visited, topic.type) << topic.name;
  }
  EXPECT_THROW(visit_message_type(static_cast<MessageId>(200), []<class T>() {}), BusError);
}

TEST(QosProfiles, only_the_raw_frame_shares_the_writers_memory) {
  for (const TopicFacts& topic : all_topics()) {
    const QosSettings settings = qos_settings(topic.profile);
    const auto is_frame = [&](const FrameTopic& frames) { return frames.type == topic.type; };
    EXPECT_EQ(settings.data_sharing, std::ranges::any_of(frame_topics(), is_frame)) << topic.name;
    EXPECT_TRUE(topic.plain || !settings.data_sharing) << topic.name;
    EXPECT_GE(settings.depth, 1) << topic.name;
  }
}

TEST(QosProfiles, what_late_readers_need_is_kept_for_them) {
  EXPECT_TRUE(qos_settings(topics::kKeyframes.profile).transient_local);
  EXPECT_TRUE(qos_settings(topics::kCameraInfo.profile).transient_local);
  EXPECT_TRUE(qos_settings(topics::kMapPoints.profile).transient_local);
  EXPECT_FALSE(qos_settings(topics::kFrame.profile).transient_local);
}

TEST(QosProfiles, an_unknown_profile_number_is_refused) {
  EXPECT_THROW(qos_settings(static_cast<QosProfile>(200)), BusError);
}

TEST(QosProfiles, match_themselves_and_name_what_a_reader_asks_too_much) {
  for (const TopicFacts& topic : all_topics()) {
    const QosSettings settings = qos_settings(topic.profile);
    EXPECT_EQ(inprocess::incompatible_policy(settings, settings), "") << topic.name;
  }
  const QosSettings pose = qos_settings(QosProfile::kPose), latched = qos_settings(QosProfile::kLatched);
  const QosSettings heartbeat = qos_settings(QosProfile::kHeartbeat);
  EXPECT_EQ(inprocess::incompatible_policy(pose, latched), "DURABILITY");
  EXPECT_EQ(inprocess::incompatible_policy(latched, pose), "");
  EXPECT_EQ(inprocess::incompatible_policy(pose, heartbeat), "LIVELINESS");
  QosSettings no_deadline = heartbeat;
  no_deadline.deadline_ms = 0;
  EXPECT_EQ(inprocess::incompatible_policy(no_deadline, heartbeat), "DEADLINE");
}

RawQos unusual() {
  RawQos qos;
  qos.reliable = false;
  qos.durability = RawQos::Durability::kTransientLocal;
  qos.depth = 7;
  qos.deadline_ns = 1'500'000'000;
  qos.lifespan_ns = 20'000'000;
  qos.liveliness = RawQos::Liveliness::kManualByTopic;
  qos.liveliness_lease_ns = 3'000'000'001;
  return qos;
}

TEST(OfferedQos, is_written_as_rosbag2_does) {
  EXPECT_EQ(offered_qos_text({RawQos{}}),
            "- history: 3\n  depth: 0\n  reliability: 1\n  durability: 2\n"
            "  deadline:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  liveliness: 1\n"
            "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  avoid_ros_namespace_conventions: false\n");
}

TEST(OfferedQos, reads_what_it_writes) {
  const std::vector<RawQos> offered{RawQos{}, unusual()};
  EXPECT_EQ(parse_offered_qos(offered_qos_text(offered)), offered);
  EXPECT_TRUE(parse_offered_qos(offered_qos_text({})).empty());
}

TEST(OfferedQos, reads_the_words_of_later_versions) {
  const auto offered = parse_offered_qos(
      "- history: keep_last\n  depth: 7\n  reliability: best_effort\n  durability: transient_local\n"
      "  deadline: {sec: 1, nsec: 500000000}\n  lifespan: {sec: 0, nsec: 20000000}\n"
      "  liveliness: manual_by_topic\n  liveliness_lease_duration: {sec: 3, nsec: 1}\n");
  ASSERT_EQ(offered.size(), 1U);
  EXPECT_EQ(offered[0], unusual());
}

TEST(OfferedQos, nonsense_is_the_default_or_nothing) {
  EXPECT_TRUE(parse_offered_qos("]{").empty());
  EXPECT_TRUE(parse_offered_qos("just words").empty());
  EXPECT_EQ(parse_offered_qos("- reliability: [1]\n  depth: many\n  deadline: {sec: -3, nsec: x}\n"),
            std::vector<RawQos>{RawQos{}});
}

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
