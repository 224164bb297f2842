// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// What one tracked frame says of a landmark.
struct LandmarkEvidence {
  LandmarkId landmark = kNoLandmark;
  double log_odds = 0;  ///< above 0: static
};

/// Evidence of a tracked frame: found where it should be; matched elsewhere while its neighbours fit; taken for
/// dynamic by the filter; or not found, and what is measured there lies behind it. docs/theory/tracking.md, "Belief".
std::vector<LandmarkEvidence> judge_landmarks(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking,
                                              const BeliefConfig& config);

}  // namespace rtd::slam
