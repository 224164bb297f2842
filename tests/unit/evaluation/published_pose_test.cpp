// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/integrity.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/msg/transform_eigen.hpp"

namespace rtd::eval {
namespace {

msg::TrackingResult result_at(std::int64_t stamp_ns, msg::TrackingState state) {
  msg::TrackingResult result{};
  result.stamp_ns = stamp_ns;
  result.state = state;
  result.T_world_camera = msg::to_message(Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3)));
  for (std::size_t i = 0; i < 6; ++i) result.covariance[7 * i] = 0.01;
  return result;
}

TEST(PublishedPose, has_pose_covariance_state_and_map_of_the_result) {
  msg::TrackingResult result = result_at(5, msg::TrackingState::kDoubtful);
  result.map_id = 2;
  const PublishedPose pose = published_pose(result);
  EXPECT_EQ(pose.stamp_ns, 5);
  EXPECT_EQ(pose.state, msg::TrackingState::kDoubtful);
  EXPECT_EQ(pose.map_id, 2U);
  EXPECT_EQ(pose.T_world_camera.translation(), Eigen::Vector3d(1, 2, 3));
  ASSERT_TRUE(pose.covariance.has_value());
  EXPECT_NEAR(pose.covariance->trace(), 0.06, 1e-12);
}

TEST(PublishedPose, covariance_of_zeros_or_of_the_unknown_is_none) {
  msg::TrackingResult result = result_at(5, msg::TrackingState::kOk);
  result.covariance.fill(0);
  EXPECT_FALSE(published_pose(result).covariance.has_value());
  for (std::size_t i = 0; i < 6; ++i) result.covariance[7 * i] = 1e6;
  EXPECT_FALSE(published_pose(result).covariance.has_value());
  result.covariance[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(published_pose(result).covariance.has_value());
}

TEST(PublishedPose, broken_poses_and_unknown_states_are_lost_frames) {
  msg::TrackingResult result = result_at(5, msg::TrackingState::kOk);
  result.T_world_camera.rotation_xyzw = {};
  EXPECT_EQ(published_pose(result).state, msg::TrackingState::kLost);
  EXPECT_EQ(published_pose(result_at(5, static_cast<msg::TrackingState>(77))).state, msg::TrackingState::kLost);
}

TEST(PublishedPose, measured_ones_of_the_first_map_make_a_trajectory) {
  std::vector<PublishedPose> published;
  for (const auto state : {msg::TrackingState::kOk, msg::TrackingState::kPredicted, msg::TrackingState::kDoubtful,
                           msg::TrackingState::kLost, msg::TrackingState::kOk})
    published.push_back(published_pose(result_at(static_cast<std::int64_t>(published.size()), state)));
  published.back().map_id = 1;
  const geometry::Trajectory poses = measured_poses(published);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].stamp_ns, 2);
}

}  // namespace
}  // namespace rtd::eval
