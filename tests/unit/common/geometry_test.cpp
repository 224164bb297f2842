// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <random>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::geometry {
namespace {

CameraModel tum_fr1() {
  return CameraModel(
      {517.306408, 516.469215, 318.643040, 255.313989, {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}, 640, 480});
}

TEST(CameraModel, undistort_inverts_distort_over_the_whole_image) {
  const CameraModel camera = tum_fr1();
  for (int v = 0; v <= 480; v += 40) {
    for (int u = 0; u <= 640; u += 40) {
      const Eigen::Vector2d raw(u, v);
      EXPECT_LT((camera.distort(camera.undistort(raw)) - raw).norm(), 1e-6) << u << " " << v;
    }
  }
}

TEST(CameraModel, distortion_moves_the_corner_by_pixels) {
  const CameraModel camera = tum_fr1();
  EXPECT_GT((camera.undistort({5, 5}) - Eigen::Vector2d(5, 5)).norm(), 2.0);
}

TEST(CameraModel, unproject_inverts_project) {
  const CameraModel camera = tum_fr1();
  const Eigen::Vector3d p_camera(0.3, -0.2, 1.7);
  EXPECT_LT((camera.unproject(camera.project(p_camera), p_camera.z()) - p_camera).norm(), 1e-12);
}

TEST(CameraModel, contains_respects_the_margin) {
  const CameraModel camera = tum_fr1();
  EXPECT_TRUE(camera.contains({0, 0}));
  EXPECT_FALSE(camera.contains({0, 0}, 1));
  EXPECT_FALSE(camera.contains({640, 100}));
}

TEST(Se3, log_inverts_exp_for_random_twists) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int i = 0; i < 200; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = uniform(random);
    EXPECT_LT((se3_log(se3_exp(twist)) - twist).norm(), 1e-9) << twist.transpose();
  }
}

TEST(Se3, small_angles_lose_no_precision) {
  Vector6d twist;
  twist << 1e-9, -2e-9, 3e-9, 1e-9, 2e-9, -1e-9;
  EXPECT_LT((se3_log(se3_exp(twist)) - twist).norm(), 1e-15);
}

TEST(Se3, exp_of_pure_rotation_turns_x_to_y) {
  Vector6d twist = Vector6d::Zero();
  twist[5] = M_PI / 2;
  EXPECT_LT((se3_exp(twist) * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(Se3, screw_motion_translates_along_its_arc) {
  Vector6d twist = Vector6d::Zero();
  twist[0] = M_PI / 2;  // quarter circle of radius 1 in the xy plane
  twist[5] = M_PI / 2;
  EXPECT_LT((se3_exp(twist).translation() - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
}

TEST(Se3, skew_is_the_cross_product) {
  const Eigen::Vector3d a(1, 2, 3), b(-4, 5, 0.5);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(Transform, message_keeps_the_pose) {
  Vector6d twist;
  twist << 0.1, 0.2, -0.3, 0.4, -0.5, 0.6;
  const Eigen::Isometry3d T_a_b = se3_exp(twist);
  EXPECT_TRUE(msg::to_isometry(msg::to_message(T_a_b)).isApprox(T_a_b, 1e-12));
}

}  // namespace
}  // namespace rtd::geometry
