// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/message_json.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>
#include <memory>

#include "common/msg/features.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::ros2 {
namespace {

using Json = nlohmann::ordered_json;

template <class Message>
Json read(const std::string& dds_type, const Message& message, std::size_t most_values = 0) {
  return message_json(dds_type, ros::encode<ros::Wire::kCdr>(message), most_values);
}

TEST(MessageJson, has_the_smallest_numbers_that_there_are) {
  msg::PoseStamped pose;
  pose.pose.position = {std::numeric_limits<double>::denorm_min(), -1e-310, 1e308};
  const Json json = read("geometry_msgs::msg::dds_::PoseStamped_", pose)["pose"]["position"];
  EXPECT_EQ(json["x"], std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(json["y"], -1e-310);
  EXPECT_EQ(json["z"], 1e308);
}

TEST(MessageJson, has_every_field_of_a_standard_message_by_its_name) {
  msg::Odometry odometry;
  odometry.header = {{12, 34}, "map"};
  odometry.child_frame_id = "camera";
  odometry.pose.pose.position = {1, 2, 3};
  odometry.pose.pose.orientation = {0.1, 0.2, 0.3, 0.9};
  odometry.pose.covariance[35] = 7;
  odometry.twist.twist.angular.z = -4;
  const Json json = read("nav_msgs::msg::dds_::Odometry_", odometry);
  EXPECT_EQ(json["header"], Json::parse(R"({"stamp": {"sec": 12, "nanosec": 34}, "frame_id": "map"})"));
  EXPECT_EQ(json["child_frame_id"], "camera");
  EXPECT_EQ(json["pose"]["pose"]["position"], Json::parse(R"({"x": 1.0, "y": 2.0, "z": 3.0})"));
  EXPECT_EQ(json["pose"]["pose"]["orientation"]["w"], 0.9);
  EXPECT_EQ(json["pose"]["covariance"].size(), 36U);
  EXPECT_EQ(json["pose"]["covariance"][35], 7.0);
  EXPECT_EQ(json["twist"]["twist"]["angular"]["z"], -4.0);
  EXPECT_EQ(json.items().begin().key(), "header") << "in the order of the type";
}

TEST(MessageJson, has_every_field_of_our_own_messages) {
  msg::ServiceStatus status;
  status.service = "slam";
  status.pid = -5;
  status.state = msg::ServiceState::kDegraded;
  status.metrics = {{"frames", 3.5}, {"lost", 0}};
  const Json json = read("rtd_msgs::msg::dds_::ServiceStatus_", status);
  EXPECT_EQ(json["service"], "slam");
  EXPECT_EQ(json["pid"], -5);
  EXPECT_EQ(json["state"], 3);
  EXPECT_EQ(json["metrics"][0], Json::parse(R"({"name": "frames", "value": 3.5})"));

  auto features = std::make_unique<msg::FeatureFrame>();
  features->count = 2;
  features->features[2047].object_id = -1;
  const Json frame = read("rtd_msgs::msg::dds_::FeatureFrame_", *features);
  EXPECT_EQ(frame["count"], 2);
  EXPECT_EQ(frame["features"].size(), msg::kMaxFeatures);
  EXPECT_EQ(frame["features"][2047]["object_id"], -1);
  EXPECT_EQ(frame["features"][0]["descriptor"].size(), 32U);

  msg::TrackingResult result{};
  result.stage_ms[1] = 0.1F;
  const Json tracking = read("rtd_msgs::msg::dds_::TrackingResult_", result);
  EXPECT_EQ(tracking["stage_ms"][1], 0.1);
  EXPECT_EQ(tracking["T_world_camera"]["rotation_xyzw"].size(), 4U);
  EXPECT_EQ(tracking["stage_ms"].size(), 8U);
}

TEST(MessageJson, long_arrays_are_cut_and_counted) {
  msg::Image image;
  image.data.assign(1000, 9);
  image.encoding = "mono8";
  const Json json = read("sensor_msgs::msg::dds_::Image_", image, 3);
  EXPECT_EQ(json["data"], Json::parse(R"({"count": 1000, "first": [9, 9, 9]})"));
  EXPECT_EQ(json["encoding"], "mono8");
  msg::Path path;
  path.poses.resize(5);
  EXPECT_EQ(read("nav_msgs::msg::dds_::Path_", path, 16)["poses"]["first"].size(), 4U) << "a quarter as many messages";
}

TEST(MessageJson, what_is_no_number_becomes_a_text) {
  msg::PoseStamped pose;
  pose.pose.position = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1};
  const Json json = read("geometry_msgs::msg::dds_::PoseStamped_", pose);
  EXPECT_EQ(json["pose"]["position"]["x"], "nan");
  EXPECT_EQ(json["pose"]["position"]["y"], "inf");
}

TEST(MessageJson, bytes_that_hold_no_such_message_are_refused) {
  std::vector<std::uint8_t> bytes = ros::encode<ros::Wire::kCdr>(msg::TFMessage{{msg::TransformStamped{}}});
  const std::string type = "tf2_msgs::msg::dds_::TFMessage_";
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(message_json(type, ros::Bytes(bytes).first(size), 0), ros::WireError) << size;
  }
  std::fill_n(bytes.begin() + 4, 4, 0xFF);  // 4294967295 transforms
  EXPECT_THROW(message_json(type, bytes, 3), ros::WireError);
  EXPECT_THROW(message_json("other_msgs::msg::dds_::Thing_", bytes, 3), ros::WireError);
  EXPECT_FALSE(can_read("other_msgs::msg::dds_::Thing_"));
  EXPECT_FALSE(can_read("KeyedSeq"));
  EXPECT_TRUE(can_read("rtd_msgs::msg::dds_::RgbdFrame_"));
}

}  // namespace
}  // namespace rtd::ros2
