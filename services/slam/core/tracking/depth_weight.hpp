// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace rtd::slam
