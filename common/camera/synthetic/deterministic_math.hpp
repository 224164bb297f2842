// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>

/// A scene is the same with every C library and on every processor: what C libraries round differently as float is
/// computed as double, and sums have one order (Eigen adds by twos, and without rounding between, where a processor has
/// instructions for two floats).
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

inline float dot(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return a.x() * b.x() + (a.y() * b.y() + a.z() * b.z());
}

inline Eigen::Vector3f times(const Eigen::Matrix3f& M, const Eigen::Vector3f& v) {
  return {dot(M.row(0), v), dot(M.row(1), v), dot(M.row(2), v)};
}

inline Eigen::Vector3f transformed(const Eigen::Isometry3f& T, const Eigen::Vector3f& p) {
  return times(T.linear(), p) + T.translation();
}

inline Eigen::Isometry3f composed(const Eigen::Isometry3f& T_a_b, const Eigen::Isometry3f& T_b_c) {
  Eigen::Isometry3f T_a_c = Eigen::Isometry3f::Identity();
  for (int column = 0; column < 3; ++column)
    T_a_c.linear().col(column) = times(T_a_b.linear(), T_b_c.linear().col(column));
  T_a_c.translation() = transformed(T_a_b, T_b_c.translation());
  return T_a_c;
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
