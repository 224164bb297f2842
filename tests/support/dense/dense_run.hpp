// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/dense/core/navigation_map.hpp"
#include "services/dense/core/static_map.hpp"
#include "tests/support/dense/ghost_measure.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {

struct DenseOptions {
  std::string source;         ///< URI; with masks if ghosts are measured
  FrontEndOptions front_end;  ///< mode true-mask: the map is given the true mask too
  bool use_masks = true;      ///< false: the map does not know what moves
  bool close_loops = true;    ///< slam does
  dense::DenseConfig map;
  bool grid = false;  ///< make a floor plan too, in the world of the true poses: slam knows the first of them
  dense::NavigationConfig navigation;
  int every = 5;        ///< as dense.every
  int judge_every = 5;  ///< frames that judge the cloud; 0 = none
};

struct DenseReport {
  std::vector<dense::CloudPoint> cloud;  ///< in slam's world
  GhostReport ghosts;
  std::size_t frames = 0, integrated = 0, voxels = 0;
  std::uint64_t fused = 0, masked = 0, carved = 0;
  double integrate_ms = 0;  ///< mean CPU time of a fused frame
  std::optional<occupancy::NavigationGrid> grid;
  occupancy::Volume volume;
  std::size_t scans = 0;                      ///< that the plan keeps
  double grid_integrate_ms = 0, grid_ms = 0;  ///< mean CPU time of a fused frame, CPU time of one plan
};

/// Filter, slam and static map on one source in one thread: what a lockstep run with rtd-dense computes when it keeps
/// up.
DenseReport run_dense(const DenseOptions& options);

}  // namespace rtd::test_support
