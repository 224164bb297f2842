// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// Estimates the readout time of a camera while it is tracked: what remains of the residuals of a pose after the best
/// pose is taken out grows with readout time, motion and distance from the middle row. Eq. (3)-(5). Deterministic.
class ReadoutEstimator {
 public:
  /// One tracked frame and the points that its features show. `motion` is the velocity during this frame and the
  /// readout time that its features were corrected with.
  void add(const Frame& frame, const Eigen::Isometry3d& T_world_camera, const std::vector<Association>& points,
           const ShutterMotion& motion);
  /// The readout time, s; 0 until it is sure that it is not 0.
  double readout_s() const;
  /// What it is so far, sure or not, and its standard deviation.
  double estimate_s() const;
  double sigma_s() const;

 private:
  double information_ = 0, weighted_sum_ = 0;
};

}  // namespace rtd::slam
