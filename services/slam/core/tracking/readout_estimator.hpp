// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// Estimates the weight of depth against pixels while a camera is tracked, from what landmarks leave of both:
/// docs/theory/camera.md, Eq. (8). Deterministic. Not thread-safe.
class DepthWeightEstimator {
 public:
  /// Starts from the weight that a map was made with, or from the largest, which suited most sensors.
  explicit DepthWeightEstimator(double disparity_px_m = 80.0);

  /// One tracked frame with its pose and the landmarks that agree with it.
  void add(const Frame& frame, const Eigen::Isometry3d& T_world_camera, const std::vector<Association>& points);
  /// vision::RgbdProjection::disparity_px_m for the next frame, px*m. Changes in steps of 10 %, so that a map knows few
  /// weights.
  double disparity_px_m() const { return disparity_px_m_; }

 private:
  double weighted_log_sum_ = 0, depths_ = 0;
  double disparity_px_m_;
};

/// How a frame was exposed, and what the readout time s has done to its pose: pose_offset - pose_slope * s, as
/// [translation; rotation] of vision::pose_jacobian.
struct ExposedFrame {
  geometry::Vector6d velocity_per_s = geometry::Vector6d::Zero();
  double readout_s = 0;  ///< undone before it was tracked
  geometry::Vector6d pose_slope = geometry::Vector6d::Zero(), pose_offset = geometry::Vector6d::Zero();
};

/// Estimates the readout time of a camera while it is tracked: what remains of the residuals of a pose after the best
/// pose is taken out grows with readout time, motion and distance from the middle row, and with the same of the frames
/// that the landmarks were mapped from. docs/theory/rolling_shutter.md, Eq. (3)-(6). Deterministic.
class ReadoutEstimator {
 public:
  ReadoutEstimator() = default;
  /// Continues from a readout time that was estimated before; 0 when it was not.
  explicit ReadoutEstimator(double readout_s);
  /// One tracked frame and the points that its features show. `motion` is the velocity during this frame and the
  /// readout time that its features were corrected with.
  void add(const Frame& frame, const Eigen::Isometry3d& T_world_camera, const std::vector<Association>& points,
           const LocalMap& map, const ShutterMotion& motion);
  /// The readout time, s; 0 until it is sure that it is not 0.
  double readout_s() const;
  /// What it is so far, sure or not, and its standard deviation.
  double estimate_s() const;
  double sigma_s() const;

 private:
  std::map<std::uint64_t, ExposedFrame> exposed_;  ///< by seq, the newest
  double information_ = 0, weighted_sum_ = 0;
};

}  // namespace rtd::slam
