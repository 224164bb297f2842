// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "tests/unit/evaluation/eval_paths.hpp"

namespace rtd::eval {
namespace {

using testing_support::moved;
using testing_support::some_transform;
using testing_support::winding_path;

TEST(Ate, of_identical_trajectories_is_zero) {
  const Trajectory path = winding_path(50, 0.1);
  const AteResult result = ate(path, path);
  EXPECT_EQ(result.error_m.count, 50U);
  EXPECT_NEAR(result.error_m.rmse, 0, 1e-12);
  EXPECT_TRUE(result.alignment.T_groundtruth_estimate.isApprox(Eigen::Isometry3d::Identity(), 1e-9));
}

TEST(Ate, alignment_recovers_the_rigid_transform) {
  const Trajectory groundtruth = winding_path(50, 0.1);
  const Trajectory estimate = moved(groundtruth, some_transform().inverse());
  const AteResult result = ate(estimate, groundtruth);
  EXPECT_NEAR(result.error_m.max, 0, 1e-12);
  EXPECT_TRUE(result.alignment.T_groundtruth_estimate.isApprox(some_transform(), 1e-9));
  EXPECT_EQ(result.alignment.scale, 1);
  EXPECT_TRUE(result.alignment.unique);
}

TEST(Ate, similarity_recovers_the_scale_and_rigid_does_not_hide_it) {
  const Trajectory groundtruth = winding_path(50, 0.1);
  const Trajectory estimate = moved(groundtruth, some_transform(), 0.5);
  AteOptions options;
  options.alignment = AlignmentKind::kSimilarity;
  const AteResult similarity = ate(estimate, groundtruth, options);
  EXPECT_NEAR(similarity.alignment.scale, 2.0, 1e-9);
  EXPECT_NEAR(similarity.error_m.max, 0, 1e-9);
  EXPECT_GT(ate(estimate, groundtruth).error_m.rmse, 0.1);
}

TEST(Ate, mirrored_path_is_not_fitted_by_a_reflection) {
  const Trajectory groundtruth = winding_path(50, 0.1);
  Trajectory mirrored = groundtruth;
  for (StampedPose& pose : mirrored) pose.T_world_body.translation().x() *= -1;
  const AteResult result = ate(mirrored, groundtruth);
  EXPECT_NEAR(result.alignment.T_groundtruth_estimate.linear().determinant(), 1, 1e-9);
  EXPECT_GT(result.error_m.rmse, 0.05);
}

TEST(Ate, scale_of_a_mirrored_path_is_the_best_one) {
  const Trajectory groundtruth = winding_path(50, 0.1);
  Trajectory mirrored = groundtruth;
  for (StampedPose& pose : mirrored) pose.T_world_body.translation().x() *= -1;
  AteOptions options;
  options.alignment = AlignmentKind::kSimilarity;
  EXPECT_LT(ate(mirrored, groundtruth, options).error_m.rmse, ate(mirrored, groundtruth).error_m.rmse);
  EXPECT_LT(ate(mirrored, groundtruth, options).alignment.scale, 0.999);  // a worse fit shrinks
}

TEST(Ate, error_of_one_square_with_a_known_bump) {
  // A square of side 2 whose corners are lifted by +-d in turn: rigid alignment cannot remove it, each error is d.
  constexpr double d = 0.1;
  const double x[] = {1, -1, -1, 1}, y[] = {1, 1, -1, -1};
  Trajectory groundtruth, estimate;
  for (int i = 0; i < 4; ++i) {
    StampedPose pose{i * 1'000'000'000LL, Eigen::Isometry3d::Identity()};
    pose.T_world_body.translation() << x[i], y[i], 0;
    groundtruth.push_back(pose);
    pose.T_world_body.translation().z() = i % 2 ? d : -d;
    estimate.push_back(pose);
  }
  const AteResult result = ate(estimate, groundtruth);
  EXPECT_NEAR(result.error_m.rmse, d, 1e-12);
  EXPECT_NEAR(result.error_m.min, d, 1e-12);
  EXPECT_NEAR(result.error_m.std_dev, 0, 1e-12);
}

TEST(Ate, points_carry_stamp_and_aligned_position) {
  const Trajectory groundtruth = winding_path(20, 0.1);
  const AteResult result = ate(moved(groundtruth, some_transform()), groundtruth);
  ASSERT_EQ(result.points.size(), 20U);
  EXPECT_EQ(result.points[7].stamp_ns, groundtruth[7].stamp_ns);
  EXPECT_TRUE(result.points[7].estimate_m.isApprox(groundtruth[7].T_world_body.translation(), 1e-9));
}

TEST(Ate, one_pair_fits_exactly_and_is_reported_as_ambiguous) {
  const Trajectory one = winding_path(1, 0.1);
  for (const AlignmentKind kind : {AlignmentKind::kRigid, AlignmentKind::kSimilarity}) {
    AteOptions options;
    options.alignment = kind;
    const AteResult result = ate(moved(one, some_transform()), one, options);
    EXPECT_EQ(result.error_m.count, 1U);
    EXPECT_NEAR(result.error_m.rmse, 0, 1e-12);
    EXPECT_FALSE(result.alignment.unique);
    EXPECT_EQ(result.alignment.scale, 1);
  }
}

TEST(Ate, collinear_path_has_a_small_error_and_is_reported_as_ambiguous) {
  Trajectory line;
  for (int i = 0; i < 10; ++i) {
    line.push_back({i * 100'000'000LL, Eigen::Isometry3d(Eigen::Translation3d(0.3 * i, 0, 0))});
  }
  const AteResult result = ate(moved(line, some_transform()), line);
  EXPECT_NEAR(result.error_m.max, 0, 1e-9);
  EXPECT_FALSE(result.alignment.unique);
  EXPECT_NEAR(result.alignment.T_groundtruth_estimate.linear().determinant(), 1, 1e-9);
}

TEST(Ate, standing_still_is_finite) {
  Trajectory still = winding_path(5, 0.1);
  for (StampedPose& pose : still) pose.T_world_body.setIdentity();
  AteOptions options;
  options.alignment = AlignmentKind::kSimilarity;
  EXPECT_EQ(ate(still, still, options).error_m.rmse, 0);
}

TEST(Ate, nothing_associated_gives_an_empty_result) {
  const Trajectory path = winding_path(5, 0.1);
  AteOptions options;
  options.association.offset_s = 1000;
  const AteResult result = ate(path, path, options);
  EXPECT_EQ(result.error_m.count, 0U);
  EXPECT_TRUE(std::isnan(result.error_m.rmse));
  EXPECT_FALSE(result.alignment.unique);
}

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
