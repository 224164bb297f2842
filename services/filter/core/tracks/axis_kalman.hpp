// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace rtd::filter {

/// Position and velocity along one axis: constant velocity, disturbed by white acceleration
/// (docs/theory/dynamic_points.md Eq. (9)). The unit of length is the caller's.
struct AxisKalman {
  Eigen::Vector2d state = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();

  void predict(double dt_s, double acceleration);
  /// `observe`: (1, 0) measures the position, (0, 1) the velocity.
  void update(const Eigen::RowVector2d& observe, double measured, double sigma);
};

}  // namespace rtd::filter
