// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/msg/features.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

namespace rtd::filter {

/// l = log(p / (1 - p)): independent pieces of evidence add up, 0 means "as likely as not".
inline float log_odds(double probability) {
  constexpr double kNearlyCertain = 1e-6;
  const double p = std::clamp(probability, kNearlyCertain, 1 - kNearlyCertain);
  return static_cast<float>(std::log(p / (1 - p)));
}

inline float probability(float log_odds) {
  return 1.0F / (1.0F + std::exp(-log_odds));
}

/// Per cell the log-odds that its surface is static; kNoBelief where nothing is known about it.
using CellBeliefs = std::vector<float>;
inline constexpr float kNoBelief = 1e9F;
inline bool is_known(float belief) {
  return belief < kNoBelief;
}

/// The beliefs about the surfaces of the last frame, carried to the current one. A belief is attached to a place in
/// space: what steps in front of a wall does not inherit the wall's belief, and the wall keeps it whatever a detector
/// calls it.
class SurfaceBeliefs {
 public:
  void store(const DepthGrid& grid, CellBeliefs beliefs);
  void clear() { beliefs_.clear(); }

  /// Looks up every measured cell of the current frame where `T_last_current` puts it in the last one; the depth there
  /// must agree within `tolerance_m`, at the cell or at one next to it. `rays`: viewing rays of the cells at z = 1.
  /// `where`, if given: only cells that are not 0 there.
  CellBeliefs recall(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                     const geometry::CameraModel& camera, const Eigen::Isometry3d& T_last_current,
                     const CellMask* where = nullptr, float tolerance_m = kOwnDepthM) const;

  static constexpr float kOwnDepthM = 0.15F;

 private:
  float near(int cell, float depth_m, float tolerance_m) const;

  GridShape shape_;
  std::vector<float> depth_m_;
  CellBeliefs beliefs_;
};

/// How far an object as a whole has moved in the image against the static world.
struct ObjectDrift {
  int features = 0;
  float shift_px = 0;  ///< length of the median displacement of its features
  float sigma_px = 0;  ///< its standard deviation, from the spread of the features
};

/// The drift of the features on these cells. The median of n features is sqrt(n) times more precise than each of them,
/// and waving arms in front of a trunk at rest do not change it.
ObjectDrift drift_of(const std::vector<int>& cells, const FeatureVotes& votes, std::size_t grid_cells);

/// Is the shift larger than the noise of the features and of the pose?
bool drifts(const ObjectDrift& drift, const BeliefConfig& config);

/// What geometry finds out about an object with a class in this frame.
enum class ObjectMotion { kUnknown, kMoving, kResting };

/// All that geometry found out about a frame.
struct MotionEvidence {
  const DynamicRegions& regions;
  const DepthEvidence& depth;
  const FeatureVotes& votes;
};

/// Per object. kMoving: enough of its cells are dynamic, or enough of its features are displaced. kResting: hardly a
/// cell is dynamic, enough of them were there 0.4 s ago, and its features are at their place. docs/theory/
/// dynamic_points.md section 5.
std::vector<ObjectMotion> judge_objects(const std::vector<SceneObject>& objects, const MotionEvidence& evidence,
                                        const BeliefConfig& config);

/// The object on each cell, -1 = none, not grown. Where masks overlap the higher level wins: a monitor behind a person
/// is left to geometry, the person is not. Flat objects are pictures: they cover no cell.
std::vector<std::int16_t> objects_on_cells(const GridShape& shape, const std::vector<SceneObject>& objects);

/// What a frame adds to the beliefs.
struct BeliefInput {
  const std::vector<SceneObject>& objects;
  const std::vector<ObjectMotion>& motions;    ///< per object
  const std::vector<std::int16_t>& object_on;  ///< per cell, objects_on_cells()
  const MotionEvidence& evidence;
  double elapsed_s;  ///< since the last frame
};

/// One step of the recursive Bayesian filter, docs/theory/dynamic_points.md Eq. (6)-(8): what was believed of each cell
/// (`recalled`), or the prior of its class where nothing was, and the evidence of this frame. Log-odds.
CellBeliefs update_beliefs(CellBeliefs recalled, const BeliefInput& input, const BeliefConfig& config,
                           const Techniques& techniques);

/// All that is known about a frame when its features are judged.
struct FrameKnowledge {
  GridShape shape;
  const std::vector<SceneObject>& objects;
  const std::vector<std::int16_t>& object_on;  ///< per cell, objects_on_cells()
  const CellBeliefs& beliefs;                  ///< per cell, this frame included
  const DynamicRegions& regions;
  const DepthEvidence& evidence;
  const CellMask& in_question;  ///< per cell, not 0 = it is too early to say whether the surface moves
};

/// Gives every feature its probability to be static, its flags and its object (docs/theory/dynamic_points.md section
/// 5), marks the improbable ones as removed and, if that leaves too few, keeps the best of the doubtful. Features that
/// geometry saw moving stay removed. Those on surfaces in question keep their probability, with their own flag.
std::vector<msg::Feature> weigh_static_probability(std::vector<msg::Feature> features, const FrameKnowledge& known,
                                                   const FilterConfig& config);

}  // namespace rtd::filter
