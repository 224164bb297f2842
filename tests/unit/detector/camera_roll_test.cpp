// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/camera_roll.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>

namespace rtd::detector {
namespace {

constexpr double kTolerance_rad = 1e-9;

/// Pose of a camera that stands turned by `angle_rad` about an axis of the first camera.
Eigen::Isometry3d turned(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle_rad, axis));
}

double roll_after(const Eigen::Isometry3d& T_world_camera, const RollConfig& config = {.min_roll_rad = 0}) {
  CameraRoll roll(config);
  roll.update(T_world_camera);
  return roll.roll_rad();
}

TEST(CameraRoll, is_zero_before_the_first_pose) {
  EXPECT_EQ(CameraRoll({}).roll_rad(), 0);
}

TEST(CameraRoll, is_the_turn_about_the_viewing_axis) {
  for (const double degrees : {-170.0, -90.0, -30.0, 45.0, 120.0}) {
    // A camera rolled clockwise sees the world turned the other way: turning it clockwise by the same angle helps.
    EXPECT_NEAR(roll_after(turned(degrees * kRadPerDeg, Eigen::Vector3d::UnitZ())), degrees * kRadPerDeg,
                kTolerance_rad);
  }
}

TEST(CameraRoll, does_not_mind_looking_around_or_up_and_down) {
  EXPECT_NEAR(roll_after(turned(100 * kRadPerDeg, Eigen::Vector3d::UnitY())), 0, kTolerance_rad);
  EXPECT_NEAR(roll_after(turned(60 * kRadPerDeg, Eigen::Vector3d::UnitX())), 0, kTolerance_rad);
}

TEST(CameraRoll, is_zero_when_the_camera_looks_at_the_ceiling) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 0.1, 0).normalized();
  EXPECT_EQ(roll_after(turned(89 * kRadPerDeg, axis)), 0);
}

TEST(CameraRoll, ignores_small_angles) {
  const RollConfig config{.min_roll_rad = 20 * kRadPerDeg};
  EXPECT_EQ(roll_after(turned(19 * kRadPerDeg, Eigen::Vector3d::UnitZ()), config), 0);
  EXPECT_NEAR(roll_after(turned(21 * kRadPerDeg, Eigen::Vector3d::UnitZ()), config), 21 * kRadPerDeg, kTolerance_rad);
}

TEST(CameraRoll, stays_while_there_is_no_pose) {
  RollFeedback feedback({.min_roll_rad = 0});
  feedback.put(1, turned(1.0, Eigen::Vector3d::UnitZ()));
  feedback.put(2, std::nullopt);
  Eigen::Isometry3d broken = turned(0.5, Eigen::Vector3d::UnitZ());
  broken.matrix().fill(std::numeric_limits<double>::quiet_NaN());
  feedback.put(3, broken);
  EXPECT_NEAR(feedback.roll_rad(), 1.0, kTolerance_rad);
}

TEST(CameraRoll, takes_gravity_from_a_first_camera_that_was_turned_itself) {
  RollConfig config{.down_world = down_of_first_camera(90 * kRadPerDeg, 30 * kRadPerDeg), .min_roll_rad = 0};
  EXPECT_NEAR(roll_after(turned(0, Eigen::Vector3d::UnitZ()), config), 90 * kRadPerDeg, kTolerance_rad);
  EXPECT_NEAR(roll_after(turned(-90 * kRadPerDeg, Eigen::Vector3d::UnitZ()), config), 0, kTolerance_rad);
  config.down_world = down_of_first_camera(0, 30 * kRadPerDeg);
  EXPECT_NEAR(roll_after(turned(180 * kRadPerDeg, config.down_world), config), 0,
              kTolerance_rad);  // turned round on foot
}

}  // namespace
}  // namespace rtd::detector
