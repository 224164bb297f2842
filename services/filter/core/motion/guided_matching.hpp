// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/vision/features.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/motion/view_store.hpp"

namespace rtd::filter {

/// A feature of a reference view found again in the current frame.
struct FeatureMatch {
  std::uint32_t current = 0;    ///< index in the current features
  std::uint32_t reference = 0;  ///< index in the features of the reference view
  int hamming = 0;
  bool reference_static = true;                       ///< the reference view did not judge it dynamic
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  ///< m, from the reference view's depth and pose
};

/// The features of the current frame, ready to be searched.
struct SearchableFeatures {
  std::span<const msg::Feature> features;
  const vision::FeatureGrid& grid;
  const geometry::CameraModel& camera;
};

/// How far from the prediction features of a view of this age are searched for.
double search_window_px(const geometry::CameraModel& camera, std::int64_t age_ns, const EgoMotionConfig& config);

/// Projects the measured features of `reference` into the expected current pose and takes the nearest descriptor within
/// `window_px` (plus the image of `reach_m` at its depth), if it is near enough and clearly nearer than the second.
/// Each current feature is matched at most once.
std::vector<FeatureMatch> match_by_projection(const View& reference, const SearchableFeatures& current,
                                              const Eigen::Isometry3d& T_world_camera, double window_px,
                                              const EgoMotionConfig& config, double reach_m = 0);

}  // namespace rtd::filter
