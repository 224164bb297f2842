// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/object_drift.hpp"

#include <cmath>

#include "services/filter/core/surfaces/median.hpp"

namespace rtd::filter {
namespace {

/// Variance of the median of normal values, by their median absolute deviation.
float median_variance(const std::vector<float>& values, float middle) {
  constexpr float kSigmaPerMad = 1.4826F, kMedianVariance = 1.5708F;  // pi / 2 times that of the mean
  std::vector<float> deviations;
  deviations.reserve(values.size());
  for (const float value : values) deviations.push_back(std::abs(value - middle));
  const float sigma = kSigmaPerMad * median(std::move(deviations));
  return kMedianVariance * sigma * sigma / static_cast<float>(values.size());
}

}  // namespace

ObjectDrift drift_of(const std::vector<int>& cells, const FeatureVotes& votes, std::size_t grid_cells) {
  std::vector<char> on(grid_cells, 0);
  for (const int cell : cells) on[static_cast<std::size_t>(cell)] = 1;
  std::vector<float> x_px, y_px;
  for (const FeatureShift& shift : votes.shifts) {
    if (on[static_cast<std::size_t>(shift.cell)] == 0) continue;
    x_px.push_back(shift.x_px);
    y_px.push_back(shift.y_px);
  }
  if (x_px.empty()) return {};
  const float x = median(x_px), y = median(y_px);
  return {static_cast<int>(x_px.size()), std::hypot(x, y),
          std::sqrt(median_variance(x_px, x) + median_variance(y_px, y))};
}

bool drifts(const ObjectDrift& drift, const BeliefConfig& config) {
  return drift.features >= config.min_resting_votes &&
         drift.shift_px > config.drift_sigmas * std::hypot(static_cast<double>(drift.sigma_px), config.drift_floor_px);
}

}  // namespace rtd::filter
