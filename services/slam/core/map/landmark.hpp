// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/msg/features.hpp"

namespace rtd::slam {

using KeyframeId = std::uint32_t;
using LandmarkId = std::uint32_t;
using MapId = std::uint32_t;  ///< a component of the map: what one first keyframe grew to; 0 = the first
inline constexpr KeyframeId kNoKeyframe = std::numeric_limits<KeyframeId>::max();
inline constexpr LandmarkId kNoLandmark = std::numeric_limits<LandmarkId>::max();

/// Landmark `landmark` is feature `feature` of keyframe `keyframe`.
struct Observation {
  KeyframeId keyframe = kNoKeyframe;
  std::uint32_t feature = 0;
};

struct Landmark {
  LandmarkId id = kNoLandmark;
  KeyframeId reference = kNoKeyframe;                  ///< keyframe that scale is measured from
  KeyframeId first_keyframe = kNoKeyframe;             ///< keyframe that made it
  int observation_weight = 0;                          ///< as ORB-SLAM2 counts: an observation with depth is two
  std::uint32_t visible = 1, found = 1;                ///< frames that should have seen it / did
  bool appearance_is_current = false;                  ///< descriptor and mean probability fit the observations
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< p_world, m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< mean viewing direction, camera -> landmark, world frame
  double min_distance_m = 0, max_distance_m = 0;       ///< from where the pyramid can show it
  double static_probability = 1.0;                     ///< by the map's ProbabilityRule
  double log_odds = 0.0;                               ///< of the same, with ProbabilityRule::kBelief
  msg::Descriptor descriptor{};                        ///< the observation that is nearest to all others
  std::vector<Observation> observations;               ///< ordered by keyframe, one per keyframe
};

}  // namespace rtd::slam
