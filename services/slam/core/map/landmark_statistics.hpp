// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <memory_resource>
#include <unordered_map>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// What tracking gathered about a landmark since the last keyframe.
struct LandmarkStatistics {
  LandmarkId landmark = kNoLandmark;
  std::uint32_t visible = 0, found = 0;  ///< frames that should have seen it / did
  double log_odds = 0;                   ///< change of its static probability
};
using StatisticsById = std::pmr::unordered_map<LandmarkId, LandmarkStatistics>;

/// A landmark's static probability as log odds: evidence adds up. docs/theory/tracking.md, "Belief".
inline double to_probability(double log_odds) {
  return 1 / (1 + std::exp(-log_odds));
}

/// What the first look says; one look proves little.
inline double initial_log_odds(double feature_probability) {
  constexpr double kMaxInitial = 2.0;
  const double p = std::clamp(feature_probability, 1e-3, 1 - 1e-3);
  return std::clamp(std::log(p / (1 - p)), -kMaxInitial, kMaxInitial);
}

/// `change`, cut so that `log_odds` + change stays within +-`bound`: the past counts only so much.
inline double bounded_change(double log_odds, double change, double bound) {
  return std::clamp(log_odds + change, -bound, bound) - log_odds;
}

}  // namespace rtd::slam
