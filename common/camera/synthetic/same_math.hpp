// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

/// What C libraries round differently as float, computed as double: a scene is then the same with each of them.
namespace rtd::camera::synthetic {

inline float sine(double rad) {
  return static_cast<float>(std::sin(rad));
}

inline float cosine(double rad) {
  return static_cast<float>(std::cos(rad));
}

/// Of the direction (x, y) from the x axis.
inline float angle_rad(double y, double x) {
  return static_cast<float>(std::atan2(y, x));
}

inline float power(double base, double exponent) {
  return static_cast<float>(std::pow(base, exponent));
}

/// Of `turned_rad` about a unit vector.
inline Eigen::Matrix3f rotation(float turned_rad, const Eigen::Vector3f& axis) {
  const float c = cosine(turned_rad);
  const Eigen::Vector3f s = sine(turned_rad) * axis, rest = (1 - c) * axis;
  Eigen::Matrix3f R = rest * axis.transpose();
  R.diagonal().array() += c;
  R += (Eigen::Matrix3f() << 0, -s.z(), s.y(), s.z(), 0, -s.x(), -s.y(), s.x(), 0).finished();
  return R;
}

}  // namespace rtd::camera::synthetic
