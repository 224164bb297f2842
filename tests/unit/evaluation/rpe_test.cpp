// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/trajectory_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/evaluation/eval_paths.hpp"

namespace rtd::eval {
namespace {

using testing_support::moved;
using testing_support::some_transform;
using testing_support::winding_path;

constexpr double kSpeedMps = 0.5;
constexpr double kTurnRateRadps = 0.02;

/// Straight motion along x at kSpeedMps, a pose every 0.1 s.
Trajectory straight_path(int count) {
  Trajectory path;
  for (int i = 0; i < count; ++i) {
    path.push_back({i * 100'000'000LL, Eigen::Isometry3d(Eigen::Translation3d(kSpeedMps * 0.1 * i, 0, 0))});
  }
  return path;
}

TEST(Rpe, of_the_same_motion_in_another_world_is_zero) {
  const Trajectory path = winding_path(60, 0.1);
  const RpeResult result = rpe(moved(path, some_transform()), path);
  EXPECT_EQ(result.translation_m.count, 49U);  // 60 poses, 10 steps of reach, and the step onto the last pose
  EXPECT_NEAR(result.translation_m.max, 0, 1e-12);
  EXPECT_NEAR(result.rotation_rad.max, 0, 1e-12);
}

TEST(Rpe, of_a_scale_drift_is_speed_times_drift_per_second) {
  const Trajectory groundtruth = straight_path(40);
  const Trajectory estimate = moved(groundtruth, Eigen::Isometry3d::Identity(), 1.1);
  const RpeResult second = rpe(estimate, groundtruth, {1.0, RpeUnit::kSeconds});
  EXPECT_NEAR(second.translation_m.rmse, 0.1 * kSpeedMps, 1e-12);
  EXPECT_NEAR(second.translation_m.std_dev, 0, 1e-12);
  EXPECT_NEAR(second.rotation_rad.max, 0, 1e-12);
  const RpeResult half_second = rpe(estimate, groundtruth, {0.5, RpeUnit::kSeconds});
  EXPECT_NEAR(half_second.translation_m.rmse, 0.05 * kSpeedMps, 1e-12);
}

TEST(Rpe, per_frame_spans_one_pose_and_per_metre_one_metre_of_the_estimate) {
  const Trajectory groundtruth = straight_path(60);
  const Trajectory estimate = moved(groundtruth, Eigen::Isometry3d::Identity(), 2);  // 0.1 m a frame, truth 0.05 m
  const RpeResult frame = rpe(estimate, groundtruth, {1.0, RpeUnit::kFrames});
  EXPECT_EQ(frame.translation_m.count, 58U);
  EXPECT_NEAR(frame.translation_m.rmse, 0.05, 1e-12);
  const RpeResult metre = rpe(estimate, groundtruth, {1.0, RpeUnit::kMetres});
  EXPECT_EQ(metre.translation_m.count, 49U);
  EXPECT_NEAR(metre.translation_m.rmse, 0.5, 1e-12);
}

TEST(Rpe, scale_option_removes_a_scale_error) {
  const Trajectory groundtruth = straight_path(40);
  const Trajectory estimate = moved(groundtruth, Eigen::Isometry3d::Identity(), 2);
  EXPECT_NEAR(rpe(estimate, groundtruth, {1.0, RpeUnit::kSeconds, 0.0, 0.5}).translation_m.max, 0, 1e-12);
}

TEST(Rpe, of_a_turning_drift_is_the_rate_times_the_step) {
  const Trajectory groundtruth = straight_path(60);
  Trajectory estimate = groundtruth;
  for (StampedPose& pose : estimate) {
    const double seconds = static_cast<double>(pose.stamp_ns) * 1e-9;
    pose.T_world_body.rotate(Eigen::AngleAxisd(kTurnRateRadps * seconds, Eigen::Vector3d::UnitZ()));
  }
  const RpeResult result = rpe(estimate, groundtruth, {2.0, RpeUnit::kSeconds});
  EXPECT_NEAR(result.rotation_rad.mean, 2 * kTurnRateRadps, 1e-9);
  EXPECT_NEAR(result.rotation_rad.max, 2 * kTurnRateRadps, 1e-9);
}

TEST(Rpe, is_measured_on_the_step_backwards_as_tums_tool_does) {
  // One step: truth goes 1 m along x without turning; the estimate turns by 90 degrees about z on the way. Backwards,
  // T_j_i of the estimate is (0, 1, 0) in its turned frame, the truth's is (-1, 0, 0): the error turns to (1, -1, 0) m.
  Trajectory groundtruth, estimate;
  for (int i = 0; i < 3; ++i) {
    groundtruth.push_back({i * 1'000'000'000LL, Eigen::Isometry3d(Eigen::Translation3d(std::min(i, 1), 0, 0))});
    estimate.push_back(groundtruth.back());
    if (i > 0) estimate.back().T_world_body.rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  }
  const RpeResult result = rpe(estimate, groundtruth, {1.0, RpeUnit::kFrames});
  ASSERT_EQ(result.translation_m.count, 1U);
  EXPECT_NEAR(result.translation_m.max, std::sqrt(2.0), 1e-12);  // forwards it would be 0
  EXPECT_NEAR(result.rotation_rad.max, M_PI / 2, 1e-12);
}

TEST(Rpe, steps_without_ground_truth_are_left_out) {
  const Trajectory estimate = straight_path(60);
  Trajectory groundtruth = estimate;
  groundtruth.erase(groundtruth.begin() + 20, groundtruth.begin() + 30);  // 1 s gap; 0.2 s on each side still counts
  const RpeResult result = rpe(estimate, groundtruth, {1.0, RpeUnit::kFrames});
  EXPECT_EQ(result.translation_m.count, 58U - 7U);
}

TEST(Rpe, offset_shifts_the_estimate_in_time) {
  const Trajectory groundtruth = straight_path(60);
  Trajectory late = groundtruth;
  for (StampedPose& pose : late) pose.stamp_ns += 100'000'000'000;
  EXPECT_EQ(rpe(late, groundtruth).translation_m.count, 0U);
  EXPECT_EQ(rpe(late, groundtruth, {1.0, RpeUnit::kSeconds, -100.0}).translation_m.count, 49U);
}

TEST(Rpe, too_short_trajectories_have_no_steps) {
  const Trajectory path = winding_path(1, 0.1);
  EXPECT_EQ(rpe(path, path).translation_m.count, 0U);
  EXPECT_TRUE(std::isnan(rpe({}, path).translation_m.rmse));
  EXPECT_TRUE(std::isnan(rpe(winding_path(9, 0.1), {}).translation_m.rmse));
}

}  // namespace
}  // namespace rtd::eval
