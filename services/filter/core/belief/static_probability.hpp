// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/msg/features.hpp"
#include "services/filter/core/belief/belief_update.hpp"
#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

namespace rtd::filter {

/// All that is known about a frame when its features are judged.
struct FrameKnowledge {
  GridShape shape;
  const std::vector<SceneObject>& objects;
  const std::vector<std::int16_t>& object_on;  ///< per cell, objects_on_cells()
  const CellBeliefs& beliefs;                  ///< per cell, this frame included
  const DynamicRegions& regions;
  const DepthEvidence& evidence;
  const CellMask& in_question;  ///< per cell, not 0 = it is too early to say whether the surface moves
};

/// Gives every feature its probability to be static, its flags and its object (docs/theory/dynamic_points.md section
/// 5), marks the improbable ones as removed and, if that leaves too few, keeps the best of the doubtful. Features that
/// geometry saw moving stay removed. Those on surfaces in question keep their probability, with a flag of their own.
std::vector<msg::Feature> weigh_static_probability(std::vector<msg::Feature> features, const FrameKnowledge& known,
                                                   const FilterConfig& config);

}  // namespace rtd::filter
