// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/filter/core/motion/static_consensus.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// A feature found again: at its place, or displaced against the static world.
struct FeatureVote {
  int cell = 0;
  bool moving = false;
};

/// How far a feature found again lies from its place in the static world.
struct FeatureShift {
  int cell = 0;
  float x_px = 0, y_px = 0;
};

/// The votes of all features found again and their count per depth cluster, docs/theory/dynamic_points.md Eq. (5).
/// Displacements between the two limits of the config are no vote.
struct FeatureVotes {
  std::vector<FeatureVote> votes;
  std::vector<int> resting, moving;  ///< per cluster
  std::vector<FeatureShift> shifts;  ///< of every feature found again, those without a vote too
  /// Enough of the cluster's features are displaced.
  bool cluster_moves(std::size_t cluster, const GeometryConfig& config) const;
  /// Enough of the cluster's features are at their place, and hardly one is not.
  bool cluster_rests(std::size_t cluster, const GeometryConfig& config) const;
  /// The same for displacements over a second, which need fewer features, but nearly all of them.
  bool cluster_creeps(std::size_t cluster, const GeometryConfig& config) const;
};
FeatureVotes count_votes(const std::vector<PointSighting>& sightings, const geometry::CameraModel& camera,
                         const Eigen::Isometry3d& T_world_camera, const DepthClusters& clusters);

/// The votes of the features on each cell.
struct VotesByCell {
  std::vector<int> resting, moving;
};
VotesByCell by_cell(const FeatureVotes& votes, std::size_t cells);

/// The votes outside these cells. `cells`: per cell, 1 = left out.
FeatureVotes without_votes_on(const std::vector<std::uint8_t>& cells, FeatureVotes votes,
                              const DepthClusters& clusters);

}  // namespace rtd::filter
