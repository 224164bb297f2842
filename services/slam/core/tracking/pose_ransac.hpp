// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/vision/pose_optimizer.hpp"

namespace rtd::slam {

struct PoseRansacOptions {
  int max_iterations = 200;
  double max_error_px = 5.0;  ///< at the finest octave
  int min_inliers = 15;
  int min_with_depth = 15;  ///< observations with depth that make points of their own; fewer: P3P
  std::uint64_t seed = 0;
};

struct PoseRansacResult {
  bool success = false;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int inliers = 0;
};

/// Whether a pose shows an observation where it was made, within `max_error_px` at the finest octave.
bool agrees(const vision::RgbdProjection& camera, const vision::PoseObservation& observation,
            const Eigen::Isometry3d& T_camera_world, double max_error_px);

/// Camera pose from correspondences with many outliers: triples of observations give hypotheses, by least-squares rigid
/// alignment where there is depth enough, else by P3P; reprojection of all observations counts.
/// docs/theory/tracking.md, "Reference keyframe and recovery".
PoseRansacResult estimate_pose_ransac(const vision::RgbdProjection& camera,
                                      const std::vector<vision::PoseObservation>& observations,
                                      const PoseRansacOptions& options);

}  // namespace rtd::slam
