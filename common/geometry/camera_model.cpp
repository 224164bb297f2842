// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/camera_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rtd::geometry {
namespace {

/// A calibration from outside may bend a pixel to where no number is: it then lies far outside.
Eigen::Vector2d bounded(const Eigen::Vector2d& pixel) {
  constexpr double kFarthest_px = 1e6;
  const auto bound = [](double px) { return px > -kFarthest_px ? std::min(px, +kFarthest_px) : -kFarthest_px; };
  return {bound(pixel.x()), bound(pixel.y())};
}

}  // namespace

CameraModel::CameraModel(const Parameters& parameters)
    : parameters_(parameters),
      distorted_(
          parameters.lens == Lens::kFisheye ||
          std::any_of(parameters.distortion.begin(), parameters.distortion.end(), [](double k) { return k != 0; })) {}

/// Distance from the axis in the normalised image of a fisheye lens.
double CameraModel::fisheye_radius(double angle_rad) const {
  const auto& k = parameters_.distortion;
  const double a2 = angle_rad * angle_rad;
  return angle_rad * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
}

/// Newton on the angle, which the radius of the image grows with.
Eigen::Vector2d CameraModel::undistort_fisheye(const Eigen::Vector2d& target) const {
  const double radius = target.norm();
  if (radius < 1e-12) return target;
  constexpr double kStep = 1e-6;
  double angle_rad = std::min(radius, kWidestView_rad);
  for (int i = 0; i < 20; ++i) {
    const double slope = (fisheye_radius(angle_rad + kStep) - fisheye_radius(angle_rad - kStep)) / (2 * kStep);
    const double step = (fisheye_radius(angle_rad) - radius) / std::max(slope, 1e-3);
    angle_rad = std::clamp(angle_rad - step, 0.0, kWidestView_rad);
    if (std::abs(step) < 1e-12) break;
  }
  return target * (std::tan(angle_rad) / radius);
}

Eigen::Vector2d CameraModel::distort_normalized(const Eigen::Vector2d& n) const {
  if (parameters_.lens == Lens::kFisheye) {
    const double radius = n.norm();
    return radius < 1e-12 ? n : n * (fisheye_radius(std::atan(radius)) / radius);
  }
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = parameters_.distortion;
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  const double radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Vector2d CameraModel::distort(const Eigen::Vector2d& pixel) const {
  if (!distorted_) return pixel;
  const auto& p = parameters_;
  const Eigen::Vector2d d = distort_normalized({(pixel.x() - p.cx) / p.fx, (pixel.y() - p.cy) / p.fy});
  return bounded({p.fx * d.x() + p.cx, p.fy * d.y() + p.cy});
}

Eigen::Vector2d CameraModel::undistort(const Eigen::Vector2d& raw_pixel) const {
  if (!distorted_) return raw_pixel;
  const auto& p = parameters_;
  const Eigen::Vector2d target((raw_pixel.x() - p.cx) / p.fx, (raw_pixel.y() - p.cy) / p.fy);
  if (p.lens == Lens::kFisheye) {
    const Eigen::Vector2d n = undistort_fisheye(target);
    return bounded({p.fx * n.x() + p.cx, p.fy * n.y() + p.cy});
  }
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
  return bounded({p.fx * n.x() + p.cx, p.fy * n.y() + p.cy});
}

}  // namespace rtd::geometry
