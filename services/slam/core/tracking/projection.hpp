// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/tracking/matcher.hpp"

namespace rtd::slam {

/// A world point in an image.
struct Projection {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double z_m = 0;  ///< depth along the optical axis
};

/// Where `p_world` appears in `frame` seen from `T_camera_world`; empty behind the camera or outside the image.
std::optional<Projection> project(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                                  const Eigen::Vector3d& p_world);

/// What decides whether and how large a landmark appears.
struct LandmarkView {
  Eigen::Vector3d position, normal;
  double min_distance_m, max_distance_m;
};

struct PredictedView {
  Projection projection;
  int octave = 0;
  double view_cosine = 1;  ///< of the angle between this ray and the landmark's mean ray
};

/// Viewing angles beyond this cosine (60 degrees) are not expected to look alike.
inline constexpr double kMinViewCosine = 0.5;

/// Whether a landmark should be visible and in which octave: inside the image, within its distance range, seen from a
/// similar side. docs/theory/tracking.md Eq. (5).
std::optional<PredictedView> predict_view(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                                          const Eigen::Isometry3d& T_camera_world, const LandmarkView& landmark);

/// Window around a predicted view, octaves [octave - 1, octave].
SearchPoint make_search_point(const PredictedView& view, double radius_px, const msg::Descriptor& descriptor,
                              std::uint32_t tag);

}  // namespace rtd::slam
