// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/topic_registry.hpp"

#include <gtest/gtest.h>

namespace rtd::recorder {
namespace {

TEST(TopicFilter, a_star_crosses_slashes) {
  const TopicFilter slam({"rt/slam/*"});
  EXPECT_TRUE(slam.wants("rt/slam/odometry"));
  EXPECT_TRUE(slam.wants("rt/slam/debug/points"));
  EXPECT_FALSE(slam.wants("rt/tf"));
  EXPECT_TRUE(TopicFilter({"*"}).wants("rtd/frame"));
}

TEST(TopicFilter, takes_names_of_ros_too) {
  const TopicFilter filter({"/slam/odometry", "/camera/*"});
  EXPECT_TRUE(filter.wants("rt/slam/odometry"));
  EXPECT_TRUE(filter.wants("rt/camera/color/camera_info"));
  EXPECT_FALSE(filter.wants("rt/slam/odometry2"));
  EXPECT_FALSE(filter.wants("rtd/frame"));
}

TEST(TopicFilter, knows_the_other_signs_of_a_shell) {
  EXPECT_TRUE(TopicFilter({"rtd/[fk]*"}).wants("rtd/keyframes"));
  EXPECT_FALSE(TopicFilter({"rtd/[fk]*"}).wants("rtd/status"));
  EXPECT_TRUE(TopicFilter({"rt/camera?/image"}).wants("rt/camera2/image"));
  EXPECT_FALSE(TopicFilter({}).wants("rt/tf"));
}

TEST(TopicFilter, takes_requests_and_replies_of_services_only_by_their_names) {
  EXPECT_FALSE(TopicFilter({"*"}).wants("rr/slam/resetReply"));
  EXPECT_TRUE(TopicFilter({"rr/*"}).wants("rr/slam/resetReply"));
}

TEST(TopicFilter, of_a_robot_leaves_out_the_topics_of_others) {
  const TopicFilter all({"*"}, "anna"), pose({"/slam/pose", "rtd/frame"}, "anna");
  EXPECT_TRUE(all.wants("rt/anna/slam/pose"));
  EXPECT_TRUE(all.wants("rt/tf"));
  EXPECT_FALSE(all.wants("rt/bert/slam/pose"));
  EXPECT_TRUE(TopicFilter({"*"}).wants("rt/bert/slam/pose")) << "without a name: all robots";
  EXPECT_TRUE(pose.wants("rt/anna/slam/pose"));
  EXPECT_TRUE(pose.wants("rtd/anna/frame"));
  EXPECT_FALSE(pose.wants("rtd/bert/frame"));
}

}  // namespace
}  // namespace rtd::recorder
