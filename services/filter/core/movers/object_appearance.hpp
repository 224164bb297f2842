// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "services/filter/core/movers/object_sighting.hpp"

namespace rtd::filter {

/// What some points say about the object that they lie on; world frame.
struct ObjectAppearance {
  Eigen::Vector3d view;        ///< from the camera, unit
  Eigen::Vector3d right;       ///< across the view, unit
  Eigen::Vector3d surface;     ///< middle of what is seen
  Eigen::Vector3d body;        ///< middle of what moves as one, behind the surface
  Eigen::AlignedBox3d extent;  ///< as thick as things of its size are
  double width_m = 0;          ///< across
  double thickness_m = 0;      ///< along the view, as far as the width shows
  ColorHistogram tints = ColorHistogram::Zero();
  bool cut_left = false, cut_right = false;
  bool covers(const Eigen::Vector3d& p) const {
    constexpr double kBesideM = 0.1;
    return extent.exteriorDistance(p) < kBesideM;
  }
};

/// `upright`: a person rather than a thing. At least one point.
ObjectAppearance measure(const std::vector<SeenPoint>& points, bool upright, const Eigen::Isometry3d& T_world_camera);
/// Of the surface that was taken for the object.
ObjectAppearance measure(const ObjectSighting& sighting, const Eigen::Isometry3d& T_world_camera);

}  // namespace rtd::filter
