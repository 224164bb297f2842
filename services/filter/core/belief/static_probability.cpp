// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/static_probability.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/vision/samples.hpp"

namespace rtd::filter {

void SurfaceBeliefs::store(const DepthGrid& grid, CellBeliefs beliefs) {
  shape_ = grid.shape;
  depth_m_ = grid.depth_m;
  beliefs_ = std::move(beliefs);
}

float SurfaceBeliefs::near(int cell, float depth_m, float tolerance_m) const {
  const int column = cell % shape_.columns;
  const auto fits = [&](int at) { return std::abs(depth_m_[static_cast<std::size_t>(at)] - depth_m) < tolerance_m; };
  if (fits(cell)) return beliefs_[static_cast<std::size_t>(cell)];
  if (column > 0 && fits(cell - 1)) return beliefs_[static_cast<std::size_t>(cell - 1)];
  if (column + 1 < shape_.columns && fits(cell + 1)) return beliefs_[static_cast<std::size_t>(cell + 1)];
  if (cell >= shape_.columns && fits(cell - shape_.columns))
    return beliefs_[static_cast<std::size_t>(cell - shape_.columns)];
  if (cell + shape_.columns < shape_.size() && fits(cell + shape_.columns))
    return beliefs_[static_cast<std::size_t>(cell + shape_.columns)];
  return kNoBelief;
}

CellBeliefs SurfaceBeliefs::recall(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                                   const geometry::CameraModel& camera, const Eigen::Isometry3d& T_last_current,
                                   const CellMask* where, float tolerance_m) const {
  constexpr float kMinDepthM = 0.1F;
  CellBeliefs recalled(grid.depth_m.size(), kNoBelief);
  if (beliefs_.empty() || !(shape_ == grid.shape)) return recalled;
  const Eigen::Matrix3f rotation = T_last_current.linear().cast<float>();
  const Eigen::Vector3f translation = T_last_current.translation().cast<float>();
  const auto& p = camera.parameters();
  const auto fx = static_cast<float>(p.fx), fy = static_cast<float>(p.fy);
  const auto cx = static_cast<float>(p.cx), cy = static_cast<float>(p.cy);
  for (std::size_t cell = 0; cell < recalled.size(); ++cell) {
    if (grid.depth_m[cell] <= 0 || (where != nullptr && (*where)[cell] == 0)) continue;
    const Eigen::Vector3f p_last = rotation * (rays[cell] * grid.depth_m[cell]) + translation;
    if (p_last.z() < kMinDepthM) continue;
    const int at = shape_.cell_at(fx * p_last.x() / p_last.z() + cx, fy * p_last.y() / p_last.z() + cy);
    if (at >= 0) recalled[cell] = near(at, p_last.z(), tolerance_m);
  }
  return recalled;
}

namespace {

constexpr double kMinMovingCells = 0.2;        ///< share of its cells dynamic: the object moves
constexpr int kMinMovingVotes = 8;             ///< or this many of its features displaced
constexpr double kMinMovingVotesShare = 0.35;  ///< ... and this share of them
constexpr double kMaxDynamicCells = 0.05;      ///< share of its cells dynamic: less, it may rest
constexpr double kMinLastingCells = 0.3;       ///< ... this share there 0.4 s ago
constexpr int kMinRestingVotes = 12;           ///< ... this many features at their place
constexpr double kMinRestingRatio = 5.0;       ///< ... this many times more than displaced ones
constexpr double kGainPerS = 10.0;             ///< log-odds for each second at rest
constexpr double kBeliefForgetS = 2.0;  ///< time constant with which a belief returns to the prior without a statement

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
  if (dynamic >= kMinMovingCells * cells) return ObjectMotion::kMoving;
  if (moving >= kMinMovingVotes && moving >= kMinMovingVotesShare * (moving + resting)) return ObjectMotion::kMoving;
  if (object.level == MotionLevel::kHigh && drifts(drift_of(object.cells, evidence.votes, votes.moving.size()), config))
    return ObjectMotion::kMoving;
  const bool features_rest = resting >= kMinRestingVotes && resting >= kMinRestingRatio * moving;
  if (dynamic <= kMaxDynamicCells * cells && lasting >= kMinLastingCells * cells && features_rest)
    return ObjectMotion::kResting;
  return ObjectMotion::kUnknown;
}

/// How the belief in surfaces of one motion level behaves, per step of this frame.
struct Pace {
  float prior;
  float gain;   ///< log-odds that a frame of rest adds
  float limit;  ///< rest alone lifts it no higher
};

/// The numbers of the config for a frame that took this long.
class BeliefStep {
 public:
  BeliefStep(const BeliefInput& input, const BeliefConfig& config, const Techniques& techniques)
      : input_(input), techniques_(techniques), lowest_(log_odds(config.lowest_probability)) {
    constexpr double kLongestStepS = 0.2;  // a pause of the camera is no evidence
    const double step_s = std::clamp(input.elapsed_s, 0.0, kLongestStepS);
    const auto highest = log_odds(config.highest_probability);
    const auto gain = static_cast<float>(kGainPerS * step_s),
               high_gain = static_cast<float>(config.high_gain_per_s * step_s);
    background_ = {log_odds(config.background_prior), gain, highest};
    medium_ = {log_odds(config.medium_prior), gain, highest};
    high_ = {log_odds(config.high_prior), high_gain, log_odds(config.high_limit)};
    forgotten_ = static_cast<float>(1 - std::exp(-step_s / kBeliefForgetS));
    if (!techniques.belief) background_.gain = medium_.gain = highest - lowest_;  // one frame decides
    if (!techniques.belief || !techniques.resting_objects) high_.gain = 0;
  }

  float operator()(std::size_t cell, float recalled) const {
    const std::int16_t on = input_.object_on[cell];
    const SceneObject* object = on < 0 ? nullptr : &input_.objects[static_cast<std::size_t>(on)];
    const ObjectMotion motion = on < 0 ? ObjectMotion::kUnknown : input_.motions[static_cast<std::size_t>(on)];
    const Pace& pace = pace_of(object);
    const bool never_used = object != nullptr && object->level == MotionLevel::kHigh && !techniques_.resting_objects;
    const float before = !is_known(recalled) ? pace.prior : never_used ? std::min(recalled, pace.prior) : recalled;
    const MotionEvidence& evidence = input_.evidence;
    if (evidence.regions.hold_cs[cell] > 0 || motion == ObjectMotion::kMoving) return lowest_;
    if (!evidence.regions.trusted) return before;
    if (evidence.depth.violated[cell] == 0 && rests(cell, object, motion))
      return std::min(before + pace.gain, std::max(before, pace.limit));
    return before + forgotten_ * (pace.prior - before);
  }

 private:
  const Pace& pace_of(const SceneObject* object) const {
    if (object == nullptr || object->level == MotionLevel::kLow) return background_;
    return object->level == MotionLevel::kHigh ? high_ : medium_;
  }
  /// An object rests as a whole or not at all: the inside of a slow mover looks as if it had always been there.
  bool rests(std::size_t cell, const SceneObject* object, ObjectMotion motion) const {
    if (object != nullptr && object->level != MotionLevel::kLow) return motion == ObjectMotion::kResting;
    return input_.evidence.depth.consistent[cell] > 0 || input_.evidence.depth.lasting[cell] > 0;
  }

  const BeliefInput& input_;
  const Techniques& techniques_;
  float lowest_;
  float forgotten_ = 0;
  Pace background_{}, medium_{}, high_{};
};

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
  constexpr float kRounding = 1.01F;  // of beliefs, which are log-odds
  const auto seen_moving = static_cast<float>(config.belief.lowest_probability) * kRounding;
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
  return drift.features >= kMinRestingVotes &&
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

std::vector<std::int16_t> objects_on_cells(const GridShape& shape, const std::vector<SceneObject>& objects) {
  std::vector<std::int16_t> on(static_cast<std::size_t>(shape.size()), -1);
  for (const MotionLevel level : {MotionLevel::kLow, MotionLevel::kMedium, MotionLevel::kHigh}) {
    for (std::size_t k = 0; k < objects.size(); ++k) {
      if (objects[k].level != level || objects[k].flat) continue;
      for_each_covered_cell(objects[k], [&](std::size_t cell) { on[cell] = static_cast<std::int16_t>(k); });
    }
  }
  return on;
}

CellBeliefs update_beliefs(CellBeliefs recalled, const BeliefInput& input, const BeliefConfig& config,
                           const Techniques& techniques) {
  const BeliefStep step(input, config, techniques);
  for (std::size_t cell = 0; cell < recalled.size(); ++cell) {
    recalled[cell] = step(cell, techniques.belief ? recalled[cell] : kNoBelief);
  }
  return recalled;
}

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
