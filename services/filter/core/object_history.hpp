// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/filter/core/depth_check.hpp"
#include "services/filter/core/dynamic_regions.hpp"
#include "services/filter/core/object_masks.hpp"

namespace rtd::filter {

/// What geometry says of an object with a class.
enum class ObjectMotion { kUnknown, kMoving, kResting };

/// kMoving: enough of its cells are dynamic; kResting: none worth mentioning and enough were found at their place.
ObjectMotion judge_motion(const SceneObject& object, const DynamicRegions& regions, const DepthEvidence& evidence);

/// How long each object has been at rest: follows objects from frame to frame by the overlap of their masks.
class ObjectHistory {
 public:
  /// Seconds for which each object of this frame has been seen resting without a break; 0 when it moves or is unknown.
  std::vector<double> update(const std::vector<SceneObject>& objects, const std::vector<ObjectMotion>& motions,
                             std::int64_t stamp_ns);
  void clear() { known_.clear(); }

 private:
  struct Known {
    SceneObject object;
    ObjectMotion motion;
    std::int64_t resting_since_ns;
  };
  const Known* same_object(const SceneObject& object) const;
  std::vector<Known> known_;
};

}  // namespace rtd::filter
