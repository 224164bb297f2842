// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/static_probability.hpp"

#include <algorithm>
#include <utility>

#include "services/filter/core/belief/surface_beliefs.hpp"

namespace rtd::filter {
namespace {

constexpr float kMovingProbability = 0.02F;  // geometry sees it move

msg::FeatureFlag mask_flag(MotionLevel level) {
  switch (level) {
    case MotionLevel::kHigh:
      return msg::kFeatureInHighMask;
    case MotionLevel::kMedium:
      return msg::kFeatureInMediumMask;
    case MotionLevel::kLow:
      break;
  }
  return msg::kFeatureInLowMask;
}

/// Per cell, not 0 = no mask grows onto it: the surroundings of one object by its mask of pixels, where no object is.
CellMask without_growth(const FrameKnowledge& known, int dilate_cells) {
  const CellMask none(static_cast<std::size_t>(known.shape.size()), 0);
  CellMask around = none;
  for (const SceneObject& object : known.objects) {
    for (const int cell : object.around) around[static_cast<std::size_t>(cell)] = 1;
  }
  if (around == none) return around;
  for (const SceneObject& object : known.objects) {
    if (object.flat) continue;
    CellMask grown = none;
    for_each_covered_cell(object, [&](std::size_t cell) { grown[cell] = 1; });
    grown = dilate(known.shape, std::move(grown), dilate_cells);
    for (const int cell : object.around) grown[static_cast<std::size_t>(cell)] = 0;
    for (std::size_t cell = 0; cell < grown.size(); ++cell) around[cell] = grown[cell] == 0 ? around[cell] : 0;
  }
  return around;
}

/// The object on each cell, dilated, -1 = none. Where masks overlap the higher level wins: a monitor behind a person is
/// left to geometry, the person is not.
std::vector<std::int16_t> paint_objects(const FrameKnowledge& known, int dilate_cells, const CellMask& around) {
  std::vector<std::int16_t> order;  // objects in ascending order of level
  std::vector<std::int16_t> rank(static_cast<std::size_t>(known.shape.size()), -1);
  for (const MotionLevel level : {MotionLevel::kLow, MotionLevel::kMedium, MotionLevel::kHigh}) {
    for (std::size_t k = 0; k < known.objects.size(); ++k) {
      if (known.objects[k].level != level) continue;
      for_each_covered_cell(known.objects[k],
                            [&](std::size_t cell) { rank[cell] = static_cast<std::int16_t>(order.size()); });
      order.push_back(static_cast<std::int16_t>(k));
    }
  }
  std::vector<std::int16_t> painted = largest_near(known.shape, std::move(rank), dilate_cells);
  for (std::size_t cell = 0; cell < painted.size(); ++cell) {
    const std::int16_t of = painted[cell];
    painted[cell] = of < 0 || around[cell] != 0 ? std::int16_t{-1} : order[static_cast<std::size_t>(of)];
  }
  return painted;
}

/// What moves, dilated.
CellMask paint_motion(const FrameKnowledge& known, int dilate_cells, const CellMask& around) {
  CellMask painted = dilate(known.shape, known.regions.hold_cs, dilate_cells);
  for (std::size_t cell = 0; cell < painted.size(); ++cell) {
    if (around[cell] != 0) painted[cell] = known.regions.hold_cs[cell];
  }
  return painted;
}

/// The beliefs with those in objects that may not be used spread around them: the outline of a mask is not exact.
CellBeliefs grow_doubt(const FrameKnowledge& known, int cells, const CellMask& around) {
  CellBeliefs doubt(known.beliefs.size(), 0);
  for (std::size_t cell = 0; cell < doubt.size(); ++cell) {
    if (known.object_on[cell] >= 0) doubt[cell] = std::min(known.beliefs[cell], 0.0F);
  }
  CellBeliefs grown = smallest_near(known.shape, std::move(doubt), cells);
  for (std::size_t cell = 0; cell < grown.size(); ++cell) {
    const bool doubted = grown[cell] < 0 && around[cell] == 0;
    grown[cell] = doubted ? std::min(known.beliefs[cell], grown[cell]) : known.beliefs[cell];
  }
  return grown;
}

/// Keeps the most probable of the removed features until enough remain.
void keep_best_of_doubtful(std::vector<msg::Feature>& features, const FilterConfig& config) {
  const auto seen_moving = static_cast<float>(config.belief.lowest_probability) * 1.01F;
  int kept = 0;
  std::vector<msg::Feature*> doubtful;
  for (msg::Feature& feature : features) {
    if ((feature.flags & msg::kFeatureRemoved) == 0) {
      ++kept;
    } else if (feature.static_probability > seen_moving) {
      doubtful.push_back(&feature);
    }
  }
  std::stable_sort(doubtful.begin(), doubtful.end(),
                   [](const auto* a, const auto* b) { return a->static_probability > b->static_probability; });
  for (msg::Feature* feature : doubtful) {
    if (kept >= config.fusion.min_static_features) return;
    feature->flags &= static_cast<std::uint8_t>(~msg::kFeatureRemoved);
    ++kept;
  }
}

/// Features that are kept count in full.
void weigh_alike(std::vector<msg::Feature>& features) {
  for (msg::Feature& feature : features) {
    if ((feature.flags & msg::kFeatureRemoved) == 0) feature.static_probability = 1;
  }
}

}  // namespace

std::vector<msg::Feature> weigh_static_probability(std::vector<msg::Feature> features, const FrameKnowledge& known,
                                                   const FilterConfig& config) {
  const CellMask around = without_growth(known, config.masks.dilate_cells);
  const std::vector<std::int16_t> painted = paint_objects(known, config.masks.dilate_cells, around);
  const CellMask dynamic = paint_motion(known, config.masks.dilate_cells, around);
  const CellMask in_question = dilate(known.shape, known.in_question, config.masks.dilate_cells);
  const CellBeliefs beliefs = grow_doubt(known, config.masks.dilate_cells, around);
  for (msg::Feature& feature : features) {
    const auto cell = static_cast<std::size_t>(known.shape.nearest_cell(feature.u_px, feature.v_px));
    feature.flags = 0;
    feature.static_probability = dynamic[cell] != 0 ? kMovingProbability : probability(beliefs[cell]);
    if (dynamic[cell] != 0) {
      feature.flags |= msg::kFeatureGeometryMoving;
    } else if (known.regions.trusted && known.evidence.consistent[cell] > 0) {
      feature.flags |= msg::kFeatureGeometryStatic;
    }
    feature.object_id = painted[cell];
    if (feature.object_id >= 0) {
      const MotionLevel level = known.objects[static_cast<std::size_t>(feature.object_id)].level;
      feature.flags |= mask_flag(level);
      if (config.mode == FilterMode::kSemantic && level == MotionLevel::kHigh)
        feature.static_probability = kMovingProbability;
    }
    if (feature.static_probability < config.fusion.remove_below) {
      feature.flags |= msg::kFeatureRemoved;
    } else if (in_question[cell] != 0) {
      feature.flags |= msg::kFeatureInQuestion;
    }
  }
  keep_best_of_doubtful(features, config);
  if (!config.techniques.feature_weights) weigh_alike(features);
  return features;
}

}  // namespace rtd::filter
