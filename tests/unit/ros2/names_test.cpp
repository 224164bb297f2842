// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/names.hpp"

#include <gtest/gtest.h>

namespace rtd::ros2 {
namespace {

TEST(Ros2Names, topics_go_there_and_back) {
  EXPECT_EQ(ros_topic("rt/slam/odometry"), "/slam/odometry");
  EXPECT_EQ(ros_topic("rtd/frame"), "rtd/frame");
  EXPECT_EQ(ros_topic("rt"), "rt");
  for (const char* topic : {"rt/slam/odometry", "rtd/frame", "rt/a", "rq/add_two_intsRequest", "rt", "DDSPerfRData"}) {
    EXPECT_EQ(dds_topic(ros_topic(topic)), topic);
  }
}

TEST(Ros2Names, types_go_there_and_back) {
  EXPECT_EQ(ros_type("nav_msgs::msg::dds_::Odometry_"), "nav_msgs/msg/Odometry");
  EXPECT_EQ(ros_type("example_interfaces::srv::dds_::AddTwoInts_Request_"),
            "example_interfaces/srv/AddTwoInts_Request");
  for (const char* type : {"nav_msgs::msg::dds_::Odometry_", "KeyedSeq", "a::b::C", "x::msg::dds_::No", "dds_", ""}) {
    EXPECT_EQ(dds_type(ros_type(type)), type);
  }
}

TEST(Names, patterns_fit_either_spelling_of_a_topic) {
  for (const char* topic : {"/slam/pose", "rt/slam/pose"}) {
    for (const char* pattern : {"/slam/*", "rt/slam/pose", "rt/*", "*"}) EXPECT_TRUE(matches_topic(pattern, topic));
    for (const char* pattern : {"slam/pose", "/slam", "rtd/*"}) EXPECT_FALSE(matches_topic(pattern, topic));
  }
  EXPECT_TRUE(matches_topic("rtd/*", "rtd/anna/frame"));
}

}  // namespace
}  // namespace rtd::ros2
