// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/filter/core/depth_check.hpp"
#include "services/filter/core/depth_clusters.hpp"
#include "services/filter/core/ego_motion.hpp"

namespace rtd::filter {

/// Where the frame moves, by geometry alone.
struct DynamicRegions {
  bool trusted = false;  ///< false: no statement (no pose, or more of the image moves than can be)
  std::vector<std::uint8_t>
      frames_left;   ///< per cell, 0 = not dynamic, else how long this is believed without new evidence
  int clusters = 0;  ///< depth clusters that are dynamic as a whole
};

/// Judges whole depth clusters (share of violating cells, votes of displaced features, or what was remembered of them)
/// and, inside clusters that are not dynamic, compact groups of violating or remembered cells.
/// docs/theory/dynamic_points.md section 4. `remembered`: frames_left of the last frame, brought to this one.
DynamicRegions find_dynamic_regions(const DepthClusters& clusters, const DepthEvidence& evidence,
                                    const ClusterVotes& votes, const std::vector<std::uint8_t>& remembered,
                                    const GeometryConfig& config);

/// Cells within `radius` cells (square) of a non-zero one, the larger value winning.
std::vector<std::uint8_t> dilate(const GridShape& shape, const std::vector<std::uint8_t>& cells, int radius);

}  // namespace rtd::filter
