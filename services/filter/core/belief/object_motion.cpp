// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/object_motion.hpp"

#include "services/filter/core/belief/object_drift.hpp"

namespace rtd::filter {
namespace {

/// Votes of features per cell, to be summed over objects.
struct VotesByCell {
  std::vector<std::uint8_t> resting, moving;
};

VotesByCell by_cell(const FeatureVotes& votes, std::size_t cells) {
  VotesByCell counted{std::vector<std::uint8_t>(cells, 0), std::vector<std::uint8_t>(cells, 0)};
  for (const FeatureVote& vote : votes.votes)
    ++(vote.moving ? counted.moving : counted.resting)[static_cast<std::size_t>(vote.cell)];
  return counted;
}

ObjectMotion judge(const SceneObject& object, const MotionEvidence& evidence, const VotesByCell& votes,
                   const BeliefConfig& config) {
  int dynamic = 0, lasting = 0, resting = 0, moving = 0;
  for (const int at : object.cells) {
    const auto cell = static_cast<std::size_t>(at);
    dynamic += evidence.regions.frames_left[cell] > 0 ? 1 : 0;
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

std::vector<ObjectMotion> judge_objects(const std::vector<SceneObject>& objects, const MotionEvidence& evidence,
                                        const BeliefConfig& config) {
  std::vector<ObjectMotion> motions(objects.size(), ObjectMotion::kUnknown);
  if (!evidence.regions.trusted || objects.empty()) return motions;
  const VotesByCell votes = by_cell(evidence.votes, evidence.regions.frames_left.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i].cells.empty()) motions[i] = judge(objects[i], evidence, votes, config);
  }
  return motions;
}

}  // namespace rtd::filter
