// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/static_probability.hpp"

#include <algorithm>

namespace rtd::filter {
namespace {

constexpr float kMovingProbability = 0.02F;  // geometry saw it move
constexpr float kMayMoveProbability = 0.1F;  // a person of whom geometry says nothing

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

/// The object on each cell, dilated, -1 = none. Where masks overlap the higher level wins: a monitor behind a person is
/// left to geometry, the person is not.
std::vector<std::int16_t> paint_objects(const FrameKnowledge& known, int dilate_cells) {
  const GridShape& shape = known.shape;
  std::vector<std::int16_t> painted(static_cast<std::size_t>(shape.size()), -1);
  const auto paint_around = [&](int cell, std::int16_t object) {
    const int column = cell % shape.columns, row = cell / shape.columns;
    for (int y = std::max(0, row - dilate_cells); y <= std::min(shape.rows - 1, row + dilate_cells); ++y) {
      for (int x = std::max(0, column - dilate_cells); x <= std::min(shape.columns - 1, column + dilate_cells); ++x) {
        painted[static_cast<std::size_t>(shape.index(x, y))] = object;
      }
    }
  };
  for (const MotionLevel level : {MotionLevel::kLow, MotionLevel::kMedium, MotionLevel::kHigh}) {
    for (std::size_t k = 0; k < known.objects.size(); ++k) {
      if (known.objects[k].level != level) continue;
      for (const int cell : known.objects[k].cells) paint_around(cell, static_cast<std::int16_t>(k));
    }
  }
  return painted;
}

/// What geometry says of a cell, as a probability.
float geometric_probability(const FrameKnowledge& known, const std::vector<std::uint8_t>& dynamic, std::size_t cell,
                            const FusionConfig& fusion) {
  if (dynamic[cell] != 0) return kMovingProbability;
  if (known.regions.trusted && known.evidence.consistent[cell] > 0) return 1.0F;
  return static_cast<float>(fusion.unknown_probability);
}

/// The fusion rule for a feature on an object.
float object_probability(const FrameKnowledge& known, std::size_t object, float geometric, FilterMode mode,
                         const FusionConfig& fusion) {
  const SceneObject& on = known.objects[object];
  if (mode == FilterMode::kSemantic) return on.level == MotionLevel::kHigh ? kMovingProbability : geometric;
  if (on.flat || on.level == MotionLevel::kLow) return geometric;
  if (known.motions[object] == ObjectMotion::kMoving) return kMovingProbability;
  if (on.level == MotionLevel::kHigh) {
    const bool sits = known.resting_s[object] >= fusion.sitting_seconds;
    return std::min(geometric, sits ? static_cast<float>(fusion.sitting_probability) : kMayMoveProbability);
  }
  const bool rests = known.motions[object] == ObjectMotion::kResting;
  return std::min(geometric, rests ? 1.0F : static_cast<float>(fusion.doubtful_probability));
}

/// Takes back the most probable of the removed features until enough remain.
void keep_best_of_doubtful(std::vector<msg::Feature>& features, const FusionConfig& fusion) {
  int kept = 0;
  std::vector<msg::Feature*> doubtful;
  for (msg::Feature& feature : features) {
    if ((feature.flags & msg::kFeatureRemoved) == 0) {
      ++kept;
    } else if (feature.static_probability > kMovingProbability) {
      doubtful.push_back(&feature);
    }
  }
  std::stable_sort(doubtful.begin(), doubtful.end(),
                   [](const auto* a, const auto* b) { return a->static_probability > b->static_probability; });
  for (msg::Feature* feature : doubtful) {
    if (kept >= fusion.min_static_features) return;
    feature->flags &= static_cast<std::uint8_t>(~msg::kFeatureRemoved);
    ++kept;
  }
}

}  // namespace

void weigh_static_probability(std::vector<msg::Feature>& features, const FrameKnowledge& known, FilterMode mode,
                              const FusionConfig& fusion, int dilate_cells) {
  const std::vector<std::int16_t> painted = paint_objects(known, dilate_cells);
  const std::vector<std::uint8_t> dynamic = dilate(known.shape, known.regions.frames_left, dilate_cells);
  for (msg::Feature& feature : features) {
    const auto cell = static_cast<std::size_t>(known.shape.nearest_cell(feature.u_px, feature.v_px));
    feature.flags = 0;
    if (dynamic[cell] != 0) feature.flags |= msg::kFeatureGeometryMoving;
    if (dynamic[cell] == 0 && known.regions.trusted && known.evidence.consistent[cell] > 0)
      feature.flags |= msg::kFeatureGeometryStatic;
    feature.static_probability = geometric_probability(known, dynamic, cell, fusion);
    feature.object_id = painted[cell];
    if (feature.object_id >= 0) {
      const auto object = static_cast<std::size_t>(feature.object_id);
      feature.flags |= mask_flag(known.objects[object].level);
      feature.static_probability = object_probability(known, object, feature.static_probability, mode, fusion);
    }
    if (feature.static_probability < fusion.remove_below) feature.flags |= msg::kFeatureRemoved;
  }
  keep_best_of_doubtful(features, fusion);
}

}  // namespace rtd::filter
