// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/trajectory_diff.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rtd::recordings {
namespace {

constexpr std::int64_t kPeriodNs = 33'000'000;

geometry::Trajectory straight_walk(int poses) {
  geometry::Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    geometry::StampedPose pose{i * kPeriodNs, Eigen::Isometry3d::Identity()};
    pose.T_world_body.translation() = Eigen::Vector3d(0.01 * i, 0, 1);
    pose.T_world_body.rotate(Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d(1, 2, 3).normalized()));
    trajectory.push_back(pose);
  }
  return trajectory;
}

TEST(TrajectoryDiff, equal_poses_are_equal_without_any_tolerance) {
  const TrajectoryDiff result = diff(straight_walk(50), straight_walk(50));
  EXPECT_TRUE(result.equal());
  EXPECT_EQ(result.pairs, 50U);
}

TEST(TrajectoryDiff, finds_the_first_and_the_largest_difference_in_their_units) {
  const geometry::Trajectory a = straight_walk(10);
  geometry::Trajectory b = a;
  b[3].T_world_body.translation().x() += 0.001;
  b[5].T_world_body.translation().y() -= 0.25;
  b[7].T_world_body.rotate(Eigen::AngleAxisd(2 * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  const TrajectoryDiff result = diff(a, b);
  EXPECT_FALSE(result.equal());
  EXPECT_EQ(result.differing, 3U);
  EXPECT_EQ(result.first->stamp_ns, 3 * kPeriodNs);
  EXPECT_NEAR(result.first->translation_m, 0.001, 1e-12);
  EXPECT_EQ(result.largest_translation->stamp_ns, 5 * kPeriodNs);
  EXPECT_NEAR(result.largest_translation->translation_m, 0.25, 1e-12);
  EXPECT_EQ(result.largest_rotation->stamp_ns, 7 * kPeriodNs);
  EXPECT_NEAR(result.largest_rotation->rotation_deg, 2, 1e-9);
}

TEST(TrajectoryDiff, finds_poses_that_are_missing_on_either_side) {
  const geometry::Trajectory whole = straight_walk(10);
  geometry::Trajectory a = whole, b = whole;
  a.erase(a.begin() + 4);
  b.erase(b.begin());
  b.pop_back();
  const TrajectoryDiff result = diff(a, b);
  EXPECT_EQ(result.only_a_ns, (std::vector<std::int64_t>{0, 9 * kPeriodNs}));
  EXPECT_EQ(result.only_b_ns, (std::vector<std::int64_t>{4 * kPeriodNs}));
  EXPECT_EQ(result.differing, 0U);
  EXPECT_FALSE(result.equal());
}

TEST(TrajectoryDiff, lets_the_caller_say_what_is_the_same) {
  const geometry::Trajectory a = straight_walk(10);
  geometry::Trajectory b = a;
  for (geometry::StampedPose& pose : b) {
    pose.stamp_ns += 50'000;
    pose.T_world_body.translation().z() += 1e-4;
  }
  EXPECT_TRUE(diff(a, b, {.stamp_s = 1e-4, .translation_m = 2e-4}).equal());
  EXPECT_EQ(diff(a, b, {.stamp_s = 1e-4, .translation_m = 5e-5}).differing, 10U);
  EXPECT_EQ(diff(a, b, {.stamp_s = 1e-5, .translation_m = 2e-4}).pairs, 0U);
}

}  // namespace
}  // namespace rtd::recordings
