// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

namespace rtd::filter {

/// What geometry says of an object with a class in this frame: high / low dynamic objects are told apart by it.
enum class ObjectMotion { kUnknown, kMoving, kResting };

/// All that geometry found out about a frame.
struct MotionEvidence {
  const DynamicRegions& regions;
  const DepthEvidence& depth;
  const FeatureVotes& votes;
};

/// Per object. kMoving: enough of its cells are dynamic, or enough of its features are displaced. kResting: hardly a
/// cell is dynamic, enough of them were there 0.4 s ago, and its features are at their place. docs/theory/
/// dynamic_points.md section 5.
std::vector<ObjectMotion> judge_objects(const std::vector<SceneObject>& objects, const MotionEvidence& evidence,
                                        const BeliefConfig& config);

}  // namespace rtd::filter
