// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/camera_model.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace rtd::geometry {

CameraModel::CameraModel(const Parameters& parameters)
    : parameters_(parameters),
      distorted_(
          std::any_of(parameters.distortion.begin(), parameters.distortion.end(), [](double k) { return k != 0; })) {}

Eigen::Vector2d CameraModel::distort_normalized(const Eigen::Vector2d& n) const {
  const auto& [k1, k2, p1, p2, k3] = parameters_.distortion;
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Vector2d CameraModel::distort(const Eigen::Vector2d& pixel) const {
  if (!distorted_) return pixel;
  const auto& p = parameters_;
  const Eigen::Vector2d d = distort_normalized({(pixel.x() - p.cx) / p.fx, (pixel.y() - p.cy) / p.fy});
  return {p.fx * d.x() + p.cx, p.fy * d.y() + p.cy};
}

Eigen::Vector2d CameraModel::undistort(const Eigen::Vector2d& raw_pixel) const {
  if (!distorted_) return raw_pixel;
  const auto& p = parameters_;
  const Eigen::Vector2d target((raw_pixel.x() - p.cx) / p.fx, (raw_pixel.y() - p.cy) / p.fy);
  Eigen::Vector2d n = target;
  constexpr int kMaxIterations = 20;
  constexpr double kStep = 1e-6;  // normalised units, for the numeric Jacobian
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Vector2d residual = distort_normalized(n) - target;
    if (residual.squaredNorm() < 1e-20) break;
    Eigen::Matrix2d jacobian;
    jacobian.col(0) =
        (distort_normalized(n + Eigen::Vector2d(kStep, 0)) - distort_normalized(n - Eigen::Vector2d(kStep, 0))) /
        (2 * kStep);
    jacobian.col(1) =
        (distort_normalized(n + Eigen::Vector2d(0, kStep)) - distort_normalized(n - Eigen::Vector2d(0, kStep))) /
        (2 * kStep);
    n -= jacobian.inverse() * residual;
  }
  return {p.fx * n.x() + p.cx, p.fy * n.y() + p.cy};
}

}  // namespace rtd::geometry
