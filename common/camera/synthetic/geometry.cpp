// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {

int Geometry::add_object(std::string class_name) {
  object_classes.push_back(std::move(class_name));
  return static_cast<int>(object_classes.size()) - 1;
}

Eigen::Isometry3f upright(const Eigen::Vector3f& position_m, float turned_rad) {
  Eigen::Isometry3f T_world_body = Eigen::Isometry3f::Identity();
  T_world_body.translation() = position_m;
  T_world_body.linear() = rotation(turned_rad, Eigen::Vector3f::UnitZ());
  return T_world_body;
}

std::array<Face, 6> outer_faces(const Cuboid& cuboid) {
  using Eigen::Vector3f;
  const Vector3f center(0, 0, cuboid.size_m.z() / 2);
  const auto face = [&](const Vector3f& normal, const Vector3f& s, const Vector3f& t) {
    const auto extent = [&](const Vector3f& axis) { return dot(axis.cwiseAbs(), cuboid.size_m); };
    const Vector3f corner = center + (normal * extent(normal) - s * extent(s) - t * extent(t)) / 2;
    const Eigen::Matrix3f& R_world_cuboid = cuboid.T_world_cuboid.linear();
    return Face{transformed(cuboid.T_world_cuboid, corner),
                times(R_world_cuboid, s),
                times(R_world_cuboid, t),
                extent(s),
                extent(t),
                cuboid.surface};
  };
  const Vector3f x = Vector3f::UnitX(), y = Vector3f::UnitY(), z = Vector3f::UnitZ();
  return {face(x, y, z), face(-x, -y, z), face(y, -x, z), face(-y, x, z), face(z, x, y), face(-z, -x, y)};
}

}  // namespace rtd::camera::synthetic
