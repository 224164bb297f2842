// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "common/msg/tracking.hpp"

namespace rtd::detector {

inline constexpr double kRadPerDeg = std::numbers::pi / 180;

/// Where down is, and when to care.
struct RollConfig {
  /// Direction of gravity in the frame of slam's poses, which is that of the first camera: the default means that the
  /// first image was upright.
  Eigen::Vector3d down_world = Eigen::Vector3d::UnitY();
  double min_roll_rad = 25 * kRadPerDeg;  ///< smaller ones are taken as 0: people are found all the same
};

/// Gravity in the frame of a first camera that was itself rolled (as CameraRoll counts) and looked down by a pitch.
Eigen::Vector3d down_of_first_camera(double roll_rad, double pitch_rad);

/// By how much the camera is rolled, from slam's poses.
class CameraRoll {
 public:
  explicit CameraRoll(const RollConfig& config) : config_(config) {}

  /// Results without a pose change nothing: the last roll holds.
  void on_tracking(const msg::TrackingResult& result);

  /// The angle by which the image must be turned clockwise, as it is seen, to stand upright, in (-pi, pi]; 0 before the
  /// first pose, below the smallest angle, and when the camera looks steeply up or down, where there is no upright.
  ///   d = R_world_camera^T down_world,   roll = atan2(d_x, d_y)
  double roll_rad() const { return roll_rad_; }

 private:
  RollConfig config_;
  double roll_rad_ = 0;
};

}  // namespace rtd::detector
