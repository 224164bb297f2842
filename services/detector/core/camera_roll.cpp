// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/camera_roll.hpp"

#include <cmath>

namespace rtd::detector {
namespace {

const double kMinSineToVertical = std::sin(20 * std::numbers::pi / 180);

}  // namespace

Eigen::Vector3d down_of_first_camera(double roll_rad, double pitch_rad) {
  const double across = std::cos(pitch_rad);
  return {across * std::sin(roll_rad), across * std::cos(roll_rad), std::sin(pitch_rad)};
}

void CameraRoll::update(const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Vector3d down_camera = T_world_camera.linear().transpose() * config_.down_world;
  const double across = std::hypot(down_camera.x(), down_camera.y());
  if (!std::isfinite(across)) return;
  roll_rad_ = across < kMinSineToVertical * down_camera.norm() ? 0 : std::atan2(down_camera.x(), down_camera.y());
  if (std::abs(roll_rad_) < config_.min_roll_rad) roll_rad_ = 0;
}

void RollFeedback::put(std::int64_t stamp_ns, const std::optional<Eigen::Isometry3d>& T_world_camera) {
  {
    const std::lock_guard lock(mutex_);
    if (T_world_camera) roll_.update(*T_world_camera);
    newest_ns_ = stamp_ns;
  }
  changed_.notify_all();
}

double RollFeedback::roll_rad() const {
  const std::lock_guard lock(mutex_);
  return roll_.roll_rad();
}

bool RollFeedback::wait_for(std::int64_t stamp_ns, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return closed_ || newest_ns_ >= stamp_ns; }) && !closed_;
}

void RollFeedback::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

}  // namespace rtd::detector
