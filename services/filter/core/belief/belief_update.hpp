// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/filter/core/belief/object_motion.hpp"
#include "services/filter/core/belief/surface_beliefs.hpp"

namespace rtd::filter {

/// The object on each cell, -1 = none, not grown. Where masks overlap the higher level wins: a monitor behind a person
/// is left to geometry, the person is not. Flat objects are pictures: they cover no cell.
std::vector<std::int16_t> objects_on_cells(const GridShape& shape, const std::vector<SceneObject>& objects);

/// What a frame adds to the beliefs.
struct BeliefInput {
  const std::vector<SceneObject>& objects;
  const std::vector<ObjectMotion>& motions;    ///< per object
  const std::vector<std::int16_t>& object_on;  ///< per cell, objects_on_cells()
  const MotionEvidence& evidence;
  double elapsed_s;  ///< since the last frame
};

/// One step of the recursive Bayesian filter, docs/theory/dynamic_points.md Eq. (6)-(8): what was believed of each cell
/// (`recalled`), or the prior of its class where nothing was, and the evidence of this frame. Log-odds.
CellBeliefs update_beliefs(CellBeliefs recalled, const BeliefInput& input, const BeliefConfig& config,
                           const Techniques& techniques);

}  // namespace rtd::filter
