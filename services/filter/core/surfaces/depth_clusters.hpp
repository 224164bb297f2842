// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// Surfaces without a depth step in them: objects without a class.
struct DepthClusters {
  GridShape shape;
  std::vector<std::int32_t> label;  ///< cluster of each cell, -1 = not measured or in a cluster that is too small
  std::vector<int> cells;           ///< number of cells of each cluster
  int count() const { return static_cast<int>(cells.size()); }
};

/// Joins neighbouring cells whose depths differ by less than the step of the config (docs/theory/dynamic_points.md Eq.
/// (2)). Clusters are numbered in the order of their first cell.
DepthClusters find_depth_clusters(const DepthGrid& grid, const ClusterConfig& config);

}  // namespace rtd::filter
