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
  std::uint64_t seed = 0;
};

struct PoseRansacResult {
  bool success = false;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int inliers = 0;
};

/// Camera pose from 3D-3D correspondences with many outliers: triples of observations with depth give hypotheses
/// (least-squares rigid alignment), reprojection of all observations counts. docs/theory/tracking.md, "Recovery".
PoseRansacResult estimate_pose_ransac(const vision::RgbdProjection& camera,
                                      const std::vector<vision::PoseObservation>& observations,
                                      const PoseRansacOptions& options);

}  // namespace rtd::slam
