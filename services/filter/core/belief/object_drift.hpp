// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/motion/feature_votes.hpp"

namespace rtd::filter {

/// How far an object as a whole has moved in the image against the static world.
struct ObjectDrift {
  int features = 0;
  float shift_px = 0;  ///< length of the median displacement of its features
  float sigma_px = 0;  ///< its standard deviation, from the spread of the features
};

/// Of the features on these cells. The median of n features knows the shift sqrt(n) times better than each of them, and
/// arms that wave before a trunk at rest do not change it.
ObjectDrift drift_of(const std::vector<int>& cells, const FeatureVotes& votes, std::size_t grid_cells);

/// The shift is neither noise of the features nor of the pose.
bool drifts(const ObjectDrift& drift, const BeliefConfig& config);

}  // namespace rtd::filter
