// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cstdint>

#include "common/vision/detection.hpp"
#include "services/filter/core/config/filter_config.hpp"

namespace rtd::filter {

inline double seconds(std::int64_t ns) {
  return 1e-9 * static_cast<double>(ns);
}

/// Position and velocity along kAxes axes, first all positions: constant velocity, disturbed by white acceleration
/// (docs/theory/dynamic_points.md Eq. (9)). The unit of length is the caller's.
template <int kAxes>
struct MotionKalman {
  static constexpr int kSize = 2 * kAxes;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  template <int kMeasured>
  using Observation = Eigen::Matrix<double, kMeasured, kSize>;

  Eigen::Matrix<double, kSize, 1> state = Eigen::Matrix<double, kSize, 1>::Zero();
  Covariance covariance = Covariance::Zero();

  auto position() const { return state.template head<kAxes>(); }
  auto velocity() const { return state.template tail<kAxes>(); }

  void predict(double dt_s, double acceleration) {
    Covariance transition = Covariance::Identity(), noise = Covariance::Zero();  // white acceleration over dt
    for (int i = 0; i < kAxes; ++i) {
      const int j = kAxes + i;
      transition(i, j) = dt_s;
      noise(i, i) = dt_s * dt_s * dt_s / 3;
      noise(i, j) = noise(j, i) = dt_s * dt_s / 2;
      noise(j, j) = dt_s;
    }
    state = transition * state;
    covariance = transition * covariance * transition.transpose() + acceleration * acceleration * noise;
  }
  /// `noise`: covariance of what was measured. Joseph form: stays symmetric and positive whatever the rounding.
  template <int kMeasured>
  void update(const Observation<kMeasured>& observe, const Eigen::Matrix<double, kMeasured, 1>& measured,
              const Eigen::Matrix<double, kMeasured, kMeasured>& noise) {
    const Eigen::Matrix<double, kMeasured, kMeasured> innovation = observe * covariance * observe.transpose() + noise;
    const Eigen::Matrix<double, kSize, kMeasured> seen = covariance * observe.transpose();
    Eigen::Matrix<double, kSize, kMeasured> gain;
    if constexpr (kMeasured == 1) {
      gain = seen / innovation.value();
    } else {
      gain = seen * innovation.inverse();
    }
    state += gain * (measured - observe * state);
    const Covariance kept = Covariance::Identity() - gain * observe;
    covariance = kept * covariance * kept.transpose() + gain * noise * gain.transpose();
  }
  /// One number with the standard deviation `sigma`.
  void update(const Observation<1>& observe, double measured, double sigma) {
    using Number = Eigen::Matrix<double, 1, 1>;
    update<1>(observe, Number(measured), Number(sigma * sigma));
  }
};

/// `observe` of update(): (1, 0) measures the position, (0, 1) the velocity.
using AxisKalman = MotionKalman<1>;

/// A box in pixels of the camera's own image.
struct Box {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d size_px = Eigen::Vector2d::Zero();
  double area_px2() const { return size_px.prod(); }
};
Box box_of(const vision::Detection& detection);
/// Shared area over joint area, 0..1.
double intersection_over_union(const Box& a, const Box& b);
/// Share of a box that lies inside an image of this size, 0..1.
double visible_share(const Box& box, const Eigen::Vector2d& image_px);

/// How a box moved from one image to the next.
struct BoxFlow {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< of its centre
  double scale = 1;
};

/// Kalman filter of a box: centre and size with constant velocity, the four axes independent of each other
/// (docs/theory/dynamic_points.md Eq. (9)-(11)). Measured by detections (position) and by optical flow (velocity).
class BoxKalman {
 public:
  explicit BoxKalman(const Box& first);

  void predict(double dt_s);
  void detected(const Box& measured);
  /// The motion of the next `dt_s`, to be followed by predict(dt_s).
  void flowed(const BoxFlow& flow, double dt_s);

  Box box() const;
  Eigen::Vector2d velocity_px_s() const { return {axes_[0].state[1], axes_[1].state[1]}; }
  double sigma_px(std::size_t axis) const;  ///< of centre x, y, width, height

 private:
  /// The size that noise on this axis is measured in.
  double unit_px(std::size_t axis) const;

  std::array<AxisKalman, 4> axes_;  ///< centre x, y, width, height; px, px/s
};

}  // namespace rtd::filter
