// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <numbers>
#include <optional>

namespace rtd::detector {

inline constexpr double kRadPerDeg = std::numbers::pi / 180;

/// Where down is, and when to care.
struct RollConfig {
  /// Direction of gravity in the frame of slam's poses, which is that of the first camera: the default means that the
  /// first image was upright.
  Eigen::Vector3d down_world = Eigen::Vector3d::UnitY();
  double min_roll_rad = 25 * kRadPerDeg;  ///< smaller ones count as 0: people are found anyway
};

/// Gravity in the frame of a first camera that was itself rolled (as CameraRoll counts) and looked down by a pitch.
Eigen::Vector3d down_of_first_camera(double roll_rad, double pitch_rad);

/// By how much the camera is rolled, from slam's poses.
class CameraRoll {
 public:
  explicit CameraRoll(const RollConfig& config) : config_(config) {}

  /// Takes the newest pose. One that is not finite changes nothing: the last roll holds.
  void update(const Eigen::Isometry3d& T_world_camera);

  /// The angle by which the image must be turned clockwise, as it is seen, to stand upright, in (-pi, pi]; 0 before the
  /// first pose, below the smallest angle, and when the camera looks steeply up or down, where there is no upright.
  ///   d = R_world_camera^T down_world,   roll = atan2(d_x, d_y)
  double roll_rad() const { return roll_rad_; }

 private:
  RollConfig config_;
  double roll_rad_ = 0;
};

/// Hands the camera's roll from the thread that receives slam's poses to those that detect. Thread-safe.
class RollFeedback {
 public:
  explicit RollFeedback(const RollConfig& config) : roll_(config) {}

  /// Takes slam's result for the image of `stamp_ns`. Without a pose the last roll holds.
  void put(std::int64_t stamp_ns, const std::optional<Eigen::Isometry3d>& T_world_camera);
  /// Roll of the newest pose.
  double roll_rad() const;
  /// Waits for slam's result for the image of `stamp_ns` or a later one. False: none came within the timeout.
  bool wait_for(std::int64_t stamp_ns, std::chrono::milliseconds timeout);
  /// Ends all waiting.
  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  CameraRoll roll_;
  std::int64_t newest_ns_ = INT64_MIN;
  bool closed_ = false;
};

}  // namespace rtd::detector
