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

}  // namespace
}  // namespace rtd::eval
