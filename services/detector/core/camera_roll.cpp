// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/camera_roll.hpp"

#include <cmath>

#include "common/msg/transform_eigen.hpp"

namespace rtd::detector {
namespace {

const double kMinSineToVertical = std::sin(20 * std::numbers::pi / 180);

}  // namespace

Eigen::Vector3d down_of_first_camera(double roll_rad, double pitch_rad) {
  const double across = std::cos(pitch_rad);
  return {across * std::sin(roll_rad), across * std::cos(roll_rad), std::sin(pitch_rad)};
}

void CameraRoll::on_tracking(const msg::TrackingResult& result) {
  if (!msg::has_pose(result.state)) return;
  const Eigen::Vector3d down_camera = msg::to_isometry(result.T_world_camera).linear().transpose() * config_.down_world;
  const double across = std::hypot(down_camera.x(), down_camera.y());
  if (!std::isfinite(across)) return;
  roll_rad_ = across < kMinSineToVertical * down_camera.norm() ? 0 : std::atan2(down_camera.x(), down_camera.y());
  if (std::abs(roll_rad_) < config_.min_roll_rad) roll_rad_ = 0;
}

}  // namespace rtd::detector
