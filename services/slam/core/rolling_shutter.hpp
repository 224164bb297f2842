// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/slam/core/frame.hpp"

namespace rtd::slam {

/// Where (and how deep) a feature would have been seen had its row been exposed together with the middle one.
/// Eq. (1), (2). A feature without depth is taken for far away: only the rotation moves it.
msg::Feature undo_rolling_shutter(const msg::Feature& feature, const vision::RgbdProjection& camera, int height_px,
                                  const ShutterMotion& motion);

/// Estimates the readout time of a camera while it is tracked: what remains of the residuals of a pose after the best
/// pose is taken out grows with readout time, motion and distance from the middle row. Eq. (3)-(5). Deterministic.
class ReadoutEstimator {
 public:
  /// One tracked frame: `landmarks` holds p_world per feature, not finite where a feature has none. `motion` is the
  /// velocity during this frame and the readout time that its features were corrected with.
  void add(const Frame& frame, const Eigen::Isometry3d& T_world_camera, const std::vector<Eigen::Vector3d>& landmarks,
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
