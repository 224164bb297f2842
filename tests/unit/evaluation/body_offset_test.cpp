// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include "common/geometry/se3.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"
#include "tests/unit/evaluation/eval_paths.hpp"

namespace rtd::eval {
namespace {

using testing_support::moved;
using testing_support::some_transform;
using testing_support::winding_path;

/// What a camera that is `T_body_camera` in the body of a trajectory does.
Trajectory camera_of(const Trajectory& body, const Eigen::Isometry3d& T_body_camera) {
  return camera_truth(body, BodyOffset{T_body_camera});
}

Eigen::Isometry3d markers() {
  return Eigen::Translation3d(0.03, -0.05, 0.1) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, -1).normalized());
}

/// 1 mm and 1 mrad, another at each pose.
void disturb(Trajectory& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double phase = static_cast<double>(i * i);
    geometry::Vector6d error;
    error << std::sin(phase), std::cos(phase), std::sin(2 * phase), std::cos(3 * phase), std::sin(5 * phase), 0;
    poses[i].T_world_body = poses[i].T_world_body * geometry::se3_exp(1e-3 * error);
  }
}

TEST(BodyOffset, is_found_by_the_motions_of_both) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = moved(camera_of(body, markers()), some_transform());
  disturb(camera);
  const auto offset = find_body_offset(camera, body, 0);
  ASSERT_TRUE(offset.has_value());
  const Eigen::Isometry3d T_error = markers().inverse() * offset->T_body_camera;
  EXPECT_LT(geometry::rotation_angle_rad(T_error), 0.01);
  EXPECT_LT(T_error.translation().norm(), 0.01);
  EXPECT_FALSE(offset->of_bonn);
}

TEST(BodyOffset, is_found_although_the_estimate_jumps_for_a_fifth_of_the_time) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = camera_of(body, markers());
  disturb(camera);
  for (std::size_t i = 60; i < 100; ++i) camera[i].T_world_body = some_transform() * camera[i].T_world_body;
  const auto offset = find_body_offset(camera, body, 0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_LT(geometry::rotation_angle_rad(markers().inverse() * offset->T_body_camera), 0.01);
}

TEST(BodyOffset, a_lever_arm_alone_is_found) {
  const Trajectory body = winding_path(200, 0.1);
  const Eigen::Isometry3d arm(Eigen::Translation3d(0.4, 0, 0.2));
  Trajectory camera = camera_of(body, arm);
  disturb(camera);
  const auto offset = find_body_offset(camera, body, 0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_LT((offset->T_body_camera.translation() - arm.translation()).norm(), 0.02);
}

TEST(BodyOffset, the_body_of_bonn_is_known_by_its_turn) {
  Eigen::Matrix3d rows;
  rows << -0.9589, -0.1726, 0.2255, -0.2841, 0.5803, -0.7633, 0.0008, -0.7959, -0.6054;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(rows).normalized().toRotationMatrix();
  const Trajectory body = winding_path(200, 0.1);
  const auto offset = find_body_offset(camera_of(body, T), body, 0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_TRUE(offset->of_bonn);
}

TEST(BodyOffset, there_is_none_of_the_same_body) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = moved(body, some_transform());
  disturb(camera);
  EXPECT_FALSE(find_body_offset(camera, body, 0).has_value());
}

TEST(BodyOffset, a_bad_estimate_is_not_explained_by_one) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = body;
  for (std::size_t i = 0; i < camera.size(); ++i)
    camera[i].T_world_body.translation() += 0.3 * Eigen::Vector3d(std::sin(0.9 * static_cast<double>(i)), 0, 0);
  EXPECT_FALSE(find_body_offset(camera, body, 0).has_value());
}

TEST(BodyOffset, turns_about_one_axis_alone_show_none) {
  Trajectory body = winding_path(200, 0.1);
  for (StampedPose& pose : body) {
    const double s = static_cast<double>(pose.stamp_ns) * 1e-9;
    pose.T_world_body.linear() = Eigen::AngleAxisd(0.3 * s, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  EXPECT_FALSE(find_body_offset(camera_of(body, markers()), body, 0).has_value());
}

TEST(BodyOffset, relative_errors_are_those_of_the_camera_and_the_ate_is_of_the_positions_as_they_are) {
  const Trajectory body = winding_path(200, 0.1);
  const Trajectory camera = moved(camera_of(body, markers()), some_transform());
  const Evaluation evaluation = evaluate(camera, body);
  EXPECT_NEAR(evaluation.rpe_per_second.rotation_rad.rmse, 0, 1e-6);
  EXPECT_NEAR(evaluation.rpe_per_second.translation_m.rmse, 0, 1e-6);
  EXPECT_EQ(evaluation.ate.error_m.rmse, ate(camera, body).error_m.rmse);
  EXPECT_GT(evaluation.ate.error_m.rmse, 0.001);
}

}  // namespace
}  // namespace rtd::eval
