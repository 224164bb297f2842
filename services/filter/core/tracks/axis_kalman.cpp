// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/tracks/axis_kalman.hpp"

namespace rtd::filter {

void AxisKalman::predict(double dt_s, double acceleration) {
  Eigen::Matrix2d transition, noise;
  transition << 1, dt_s, 0, 1;
  noise << dt_s * dt_s * dt_s / 3, dt_s * dt_s / 2, dt_s * dt_s / 2, dt_s;  // white acceleration over dt
  state = transition * state;
  covariance = transition * covariance * transition.transpose() + acceleration * acceleration * noise;
}

/// Joseph form: stays symmetric and positive whatever the rounding.
void AxisKalman::update(const Eigen::RowVector2d& observe, double measured, double sigma) {
  const double variance = sigma * sigma;
  const double innovation_variance = (observe * covariance * observe.transpose()).value() + variance;
  const Eigen::Vector2d gain = covariance * observe.transpose() / innovation_variance;
  state += gain * (measured - (observe * state).value());
  const Eigen::Matrix2d kept = Eigen::Matrix2d::Identity() - gain * observe;
  covariance = kept * covariance * kept.transpose() + variance * gain * gain.transpose();
}

}  // namespace rtd::filter
