// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// Joins landmarks that are the same point seen twice: projects the landmarks of the keyframe into its neighbours and
/// theirs into it; a feature found there becomes an observation, or, if it has a landmark of its own, the landmark
/// with fewer observations goes. docs/theory/mapping.md, "Fusion". Returns how many landmarks were merged away.
int fuse_landmarks(Map& map, KeyframeId keyframe, int neighbours);

/// The same for chosen landmarks and one keyframe that may see them.
int fuse_into(Map& map, KeyframeId target, const std::vector<LandmarkId>& landmarks);

/// What these keyframes see, ascending.
std::vector<LandmarkId> landmarks_of(const Map& map, const std::vector<KeyframeId>& keyframes);

}  // namespace rtd::slam
