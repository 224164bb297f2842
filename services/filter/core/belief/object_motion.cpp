// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/object_motion.hpp"
#include "common/vision/samples.hpp"

#include <cmath>

namespace rtd::filter {
namespace {

/// Variance of the median of normal values, by their median absolute deviation.
float median_variance(const std::vector<float>& values, float middle) {
  constexpr float kSigmaPerMad = 1.4826F, kMedianVariance = 1.5708F;  // pi / 2 times that of the mean
  std::vector<float> deviations;
  deviations.reserve(values.size());
  for (const float value : values) deviations.push_back(std::abs(value - middle));
  const float sigma = kSigmaPerMad * vision::median(std::move(deviations));
  return kMedianVariance * sigma * sigma / static_cast<float>(values.size());
}

ObjectMotion judge(const SceneObject& object, const MotionEvidence& evidence, const VotesByCell& votes,
                   const BeliefConfig& config) {
  int dynamic = 0, lasting = 0, resting = 0, moving = 0;
  for (const int at : object.cells) {
    const auto cell = static_cast<std::size_t>(at);
    dynamic += evidence.regions.hold_cs[cell] > 0 ? 1 : 0;
    lasting += evidence.depth.lasting[cell] > 0 ? 1 : 0;
    resting += votes.resting[cell];
    moving += votes.moving[cell];
  }
  const auto cells = static_cast<double>(object.cells.size());
  if (dynamic >= config.min_moving_cells * cells) return ObjectMotion::kMoving;
  if (moving >= config.min_moving_votes && moving >= config.min_moving_votes_share * (moving + resting))
    return ObjectMotion::kMoving;
  if (object.level == MotionLevel::kHigh && drifts(drift_of(object.cells, evidence.votes, votes.moving.size()), config))
    return ObjectMotion::kMoving;
  const bool features_rest = resting >= config.min_resting_votes && resting >= config.min_resting_ratio * moving;
  if (dynamic <= config.max_dynamic_cells * cells && lasting >= config.min_lasting_cells * cells && features_rest)
    return ObjectMotion::kResting;
  return ObjectMotion::kUnknown;
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
  const float x = vision::median(x_px), y = vision::median(y_px);
  return {static_cast<int>(x_px.size()), std::hypot(x, y),
          std::sqrt(median_variance(x_px, x) + median_variance(y_px, y))};
}

bool drifts(const ObjectDrift& drift, const BeliefConfig& config) {
  return drift.features >= config.min_resting_votes &&
         drift.shift_px > config.drift_sigmas * std::hypot(static_cast<double>(drift.sigma_px), config.drift_floor_px);
}

std::vector<ObjectMotion> judge_objects(const std::vector<SceneObject>& objects, const MotionEvidence& evidence,
                                        const BeliefConfig& config) {
  std::vector<ObjectMotion> motions(objects.size(), ObjectMotion::kUnknown);
  if (!evidence.regions.trusted || objects.empty()) return motions;
  const VotesByCell votes = by_cell(evidence.votes, evidence.regions.hold_cs.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i].cells.empty()) motions[i] = judge(objects[i], evidence, votes, config);
  }
  return motions;
}

}  // namespace rtd::filter
