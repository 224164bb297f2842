// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/camera/synthetic/texture.hpp"

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

inline constexpr int kRoomItself = -1;  ///< no object: walls and furniture

/// How a surface returns infrared light, whatever its colour.
enum class Material : std::uint8_t {
  kPlain,
  kHead,     ///< skin with hair on it
  kDark,     ///< hair, dark cloth
  kMonitor,  ///< a screen
};

/// How a rectangle or body looks, and what it belongs to.
struct Surface {
  int texture = 0;  ///< index
  bool moving = false;
  int object = kRoomItself;  ///< index
  Material material = Material::kPlain;
};

/// A textured rectangle, seen from the side its normal axis_s x axis_t points to. World frame: z up.
struct Face {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();  ///< corner with texture coordinate (0, 0)
  Eigen::Vector3f axis_s = Eigen::Vector3f::UnitX(), axis_t = Eigen::Vector3f::UnitY();  ///< unit, orthogonal
  float width_m = 0, height_m = 0;                                                       ///< along axis_s, axis_t
  Surface surface;
};

/// A textured ellipsoid. Body frame: centre and main axes.
struct Ellipsoid {
  Eigen::Isometry3f T_world_body = Eigen::Isometry3f::Identity();
  Eigen::Vector3f semi_axes_m = Eigen::Vector3f::Ones();
  Surface surface;
};

/// Whether hair grows at a point of a head, a unit sphere here: its back (x forward) and its top (z up).
inline bool is_hair(const Eigen::Vector3f& on_sphere) {
  return on_sphere.z() > 0.45F || (on_sphere.x() < 0.1F && on_sphere.z() > -0.5F);
}

/// Everything there is to see at one moment.
struct Geometry {
  std::vector<Face> faces;
  std::vector<Ellipsoid> ellipsoids;
  std::vector<std::string> object_classes = {};  ///< index: object
  /// A new object; its index.
  int add_object(std::string class_name);
};

/// A box with one texture for all sides. Frame: origin in the middle of its lower side, z up.
struct Cuboid {
  Eigen::Isometry3f T_world_cuboid = Eigen::Isometry3f::Identity();
  Eigen::Vector3f size_m = Eigen::Vector3f::Ones();
  Surface surface;
};

/// T_world_body of something that stands at `position_m`, turned about the vertical.
Eigen::Isometry3f upright(const Eigen::Vector3f& position_m, float turned_rad);

/// The six outer sides of a cuboid.
std::array<Face, 6> outer_faces(const Cuboid& cuboid);

}  // namespace rtd::camera::synthetic
