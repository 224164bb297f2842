// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// Landmarks on probation: made by the last keyframes, kept only if tracking finds them again.
class RecentLandmarks {
 public:
  void add(const std::vector<LandmarkId>& landmarks);
  /// Removes those that are found too rarely or that too few keyframes confirm; those that lasted three keyframes
  /// leave probation. docs/theory/mapping.md, "Culling". Returns how many were removed.
  int cull(Map& map, KeyframeId newest, double min_found_ratio);
  std::size_t size() const { return landmarks_.size(); }

 private:
  std::vector<LandmarkId> landmarks_;
};

/// Covisible keyframes of the newest one that are looked at for redundancy.
inline constexpr std::size_t kMaxRedundancyCandidates = 30;

/// Whether nearly all (`redundant_ratio`) close landmarks of a keyframe are seen by at least three others at the same
/// or a finer scale. Never true for the first keyframe of a map.
bool is_redundant_keyframe(const Map& map, KeyframeId keyframe, double redundant_ratio, double close_depth_m);

}  // namespace rtd::slam
