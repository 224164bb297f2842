// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/msg/features.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// What lies beyond the outline of a surface, in cells.
struct Outline {
  int steps = 0;  ///< the scene lies farther
  int flats = 0;  ///< it continues
  int all = 0;    ///< parts beyond which nothing is known, or something nearer, too
};

/// What does not count as surroundings of an outline, per cell not 0.
struct OutlineMasks {
  const CellMask* ignored = nullptr;  ///< not looked at
  const CellMask* things = nullptr;   ///< what continues there is another thing: no continuation
};
/// Looks a few cells outwards, past the blurred edge. A step is one of at least `min_step_m`.
Outline outline_of(const std::vector<int>& cells, const DepthGrid& grid, double min_step_m,
                   const OutlineMasks& masks = {});

/// Share of the known outline of some cells beyond which the scene lies farther; 1 where nothing is known.
double outline_step_share(const std::vector<int>& cells, const DepthGrid& grid, double min_step_m);

/// What is seen in a frame.
struct Surroundings {
  const DepthGrid& grid;
  const std::vector<Eigen::Vector3f>& rays;  ///< of the cells, at z = 1
  const DepthClusters& clusters;
  std::span<const msg::Feature> features;
};

/// What is known of it already, per cell not 0.
struct KnownSurfaces {
  const CellMask& excluded;  ///< its features are not used anyway
  const CellMask& asked;     ///< was in question in the last frame
  const CellMask& decided;   ///< has been seen to rest
};

/// Cells of surfaces that may be carried things: no larger than such things are, nearer than most of what is left
/// without them, and standing out from their surroundings, or in question before. The nearest first, as long as enough
/// features with depth are left. docs/theory/dynamic_points.md section 2.
CellMask surfaces_in_question(const Surroundings& surroundings, const KnownSurfaces& known, double min_step_m);

}  // namespace rtd::filter
