// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// Bundle adjustment of the newest keyframe, its best covisible ones and all landmarks they see; older keyframes that
/// see these landmarks are fixed. Outlier observations are taken out of the map. docs/theory/mapping.md, "Local bundle
/// adjustment". `interrupted` may end it early. Returns the keyframes that moved.
std::vector<KeyframeId> adjust_local_map(Map& map, KeyframeId newest, const MapperConfig& config,
                                         const std::function<bool()>& interrupted);

}  // namespace rtd::slam
