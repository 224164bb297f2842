// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/filter/core/motion/guided_matching.hpp"
#include "services/filter/core/motion/static_consensus.hpp"
#include "services/filter/core/surfaces/depth_clusters.hpp"

namespace rtd::filter {

/// What the estimate of the camera's motion starts from.
struct EgoMotionInput {
  SearchableFeatures current;
  const std::vector<char>& excluded;   ///< per feature, 1 = on something that may move: not used for the pose
  const std::vector<int>& cluster_of;  ///< per feature, depth cluster or -1
  const DepthClusters& clusters;
  const ViewStore& views;  ///< not empty
  std::int64_t stamp_ns;
  Eigen::Isometry3d T_world_camera_predicted;
  std::int64_t look_back_ns = 0;  ///< look for what moves too slowly for 0.1 s over this time too; 0 = not now
};

/// The matches that may take part in the pose, every n-th of them, so that not more than `limit` remain.
/// `moving_cluster`: per cluster, 1 = not used.
std::vector<FeatureMatch> usable(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input,
                                 const std::vector<char>& moving_cluster, std::size_t limit);

/// Standard deviation of the displacement of a keypoint between two views: both ends are uncertain.
double displacement_sigma_px(int octave);

/// Matches as points of the world that are measured again; both ends of a displacement are uncertain.
std::vector<PointSighting> to_sightings(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input);

}  // namespace rtd::filter
