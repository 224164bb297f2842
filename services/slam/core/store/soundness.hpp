// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "services/slam/core/store/map_format.hpp"

/// What a value must be to be part of a map: asked before it is written and after it is read.
namespace rtd::slam::map_format {

inline bool is_rigid(const Eigen::Isometry3d& T) {
  constexpr double kTolerance = 1e-6;
  const Eigen::Matrix3d R = T.linear();
  return T.translation().allFinite() && R.allFinite() &&
         (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kTolerance && R.determinant() > 0;
}

inline bool is_sound(const Landmark& landmark) {
  return landmark.position.allFinite() && landmark.normal.allFinite() && std::isfinite(landmark.min_distance_m) &&
         std::isfinite(landmark.max_distance_m) && landmark.min_distance_m >= 0 && landmark.max_distance_m >= 0 &&
         landmark.static_probability >= 0 && landmark.static_probability <= 1 && std::isfinite(landmark.log_odds);
}

inline bool is_sound(const StoredCamera& camera) {
  const auto& [fx, fy, cx, cy, disparity_px_m] = camera.projection;
  const auto side = [](int px) { return px > 0 && px <= kMaxImageSide_px; };
  return std::isfinite(fx) && std::isfinite(fy) && std::isfinite(cx) && std::isfinite(cy) && fx > 1 && fy > 1 &&
         std::isfinite(disparity_px_m) && disparity_px_m > 0 && side(camera.width_px) && side(camera.height_px);
}

}  // namespace rtd::slam::map_format
