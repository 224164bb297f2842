// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/map/landmark.hpp"

namespace rtd::slam {

struct Keyframe {
  KeyframeId id = kNoKeyframe;
  FramePtr frame;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<LandmarkId> landmarks;    ///< per feature, kNoLandmark where none
  std::map<KeyframeId, int> covisible;  ///< keyframe -> landmarks in common
  KeyframeId parent = kNoKeyframe;      ///< older keyframe it was tracked from; none for the first of its map
  std::vector<KeyframeId> children;     ///< keyframes whose parent it is, ascending
  MapId map = 0;                        ///< component that it belongs to
  double way_m = 0;                     ///< from the first keyframe to this one, along the keyframes
  bool carried = true;                  ///< WitnessVerdict::carried: what it sees may become a witness
  double probation_weight = 1;          ///< factor on what landmarks weigh here that are no witnesses
  /// Of its pose in the world, (x y z rx ry rz); empty when unknown: the first of a map.
  std::optional<geometry::Matrix6d> covariance = std::nullopt;

  /// The first keyframe of its map: holds that map's frame, is never moved by adjustment nor culled.
  bool is_origin() const { return parent == kNoKeyframe; }
};

/// Where a removed keyframe was, relative to its parent.
struct RemovedKeyframe {
  KeyframeId parent = kNoKeyframe;
  Eigen::Isometry3d T_parent_camera = Eigen::Isometry3d::Identity();
};

/// Two keyframes that were found to show the same place.
struct LoopEdge {
  KeyframeId older = kNoKeyframe, newer = kNoKeyframe;
  Eigen::Isometry3d T_older_newer = Eigen::Isometry3d::Identity();  ///< between their cameras, as measured
  int inliers = 0;  ///< landmarks of the old place that the newer keyframe was found to see
};

/// All of a map that cannot be recomputed: what a map file holds.
struct MapContents {
  std::vector<Keyframe> keyframes;                              ///< by id; without `covisible` and `children`
  std::vector<Landmark> landmarks;                              ///< by id
  std::vector<std::pair<KeyframeId, RemovedKeyframe>> removed;  ///< by id
  std::vector<LoopEdge> loops;                                  ///< in the order in which they were closed
  KeyframeId next_keyframe = 0;                                 ///< ids from here on are free
  LandmarkId next_landmark = 0;
  MapId next_map = 0;
};

/// Keyframes, landmarks and which of them see each other. One writer (the mapper), no locks: readers get LocalMap
/// snapshots.
///
/// Invariants, checked by check_invariants(): an observation is known to both its keyframe and its landmark; every
/// landmark has at least one; `covisible` counts exactly the landmarks in common and is symmetric; parents are older,
/// belong to the same component and know their children.
class Map {
 public:
  Map() = default;
  /// A map as it was saved. The contents are sound: every cross reference holds (store/map_reader.hpp checks it).
  explicit Map(MapContents contents);
  /// Ids count up from 0 and are never reused. Without parent (kNoKeyframe) the keyframe starts a new component.
  KeyframeId add_keyframe(FramePtr frame, const Eigen::Isometry3d& T_world_camera, KeyframeId parent);
  /// A landmark first seen as `observation`.
  LandmarkId add_landmark(const Eigen::Vector3d& p_world, Observation observation);
  /// False when the keyframe sees this landmark already or its feature belongs to another one.
  bool add_observation(LandmarkId landmark, Observation observation);
  /// Removes the observation of one keyframe; removing the last one removes the landmark.
  void remove_observation(LandmarkId landmark, KeyframeId keyframe);
  void remove_landmark(LandmarkId landmark);
  /// `kept` takes over the observations of `lost`; where a keyframe sees both, `kept` keeps its own observation.
  void replace_landmark(LandmarkId lost, LandmarkId kept);
  /// Removes a keyframe; its children go to its parent, its pose stays known relative to it. In the place of the first
  /// of a component comes the eldest of its children, and nothing is known of it any more.
  void remove_keyframe(KeyframeId keyframe);

  /// Makes a component part of another: its first keyframe becomes a child of `parent`, an older keyframe of the other.
  /// Moves nothing: poses and landmarks are the caller's.
  void join_components(MapId joined, KeyframeId parent);

  /// Recomputes normal, distance range, descriptor and static probability from the observations.
  void refresh_landmark(LandmarkId landmark);
  void refresh_geometry(LandmarkId landmark);

  /// Null when unknown or removed.
  const Landmark* find_landmark(LandmarkId id) const { return landmarks_.find(id); }
  Landmark* find_landmark(LandmarkId id) { return landmarks_.find(id); }
  const Keyframe* find_keyframe(KeyframeId id) const { return keyframe_index_.find(id); }
  Keyframe* find_keyframe(KeyframeId id) { return keyframe_index_.find(id); }

  /// Current pose of a keyframe that exists or existed.
  Eigen::Isometry3d T_world_keyframe(KeyframeId id) const;
  /// The nearest ancestor of a keyframe that still exists, and T_ancestor_camera; itself if it exists. Throws
  /// std::out_of_range for a keyframe that never existed or was forgotten, as T_world_keyframe() and map_of() do.
  std::pair<KeyframeId, Eigen::Isometry3d> living_ancestor(KeyframeId id) const;
  /// Forgets removed keyframes, so that a long run does not gather them: all but the last `recent` to go, and those
  /// that a loop ends at. Their poses cannot be asked for any more.
  void forget_removed(std::size_t recent);
  /// Both keyframes exist or existed.
  void add_loop(const LoopEdge& loop) { loops_.push_back(loop); }
  const std::vector<LoopEdge>& loops() const { return loops_; }
  /// The map that a keyframe that exists or existed belongs to.
  MapId map_of(KeyframeId id) const;
  /// The maps that there are, oldest first.
  std::vector<MapId> maps() const;
  /// Up to `count` keyframes with at least `min_shared` landmarks in common, most first.
  std::vector<KeyframeId> best_covisible(KeyframeId id, std::size_t count, int min_shared = 15) const;

  const std::map<KeyframeId, Keyframe>& keyframes() const { return keyframes_; }
  std::vector<LandmarkId> landmark_ids() const { return landmarks_.ids(); }  ///< ascending
  std::size_t keyframe_count(MapId map) const;                               ///< of one component; 0 when there is none
  std::size_t component_count() const { return component_sizes_.size(); }
  std::size_t landmark_count() const { return landmarks_.size(); }
  bool empty() const { return keyframes_.empty(); }
  const std::map<KeyframeId, RemovedKeyframe>& removed_keyframes() const { return removed_; }
  KeyframeId next_keyframe() const { return next_keyframe_; }
  LandmarkId next_landmark() const { return next_landmark_; }
  MapId next_map() const { return next_map_; }
  /// Empty when all invariants hold, else the first that does not. For tests.
  std::string check_invariants() const;

 private:
  /// Throw std::out_of_range when unknown.
  const Keyframe& keyframe_at(KeyframeId id) const;
  Keyframe& keyframe_at(KeyframeId id);
  void adopt_child(KeyframeId parent, KeyframeId child);
  void hand_on_origin(const Keyframe& origin);
  void change_covisibility(const Landmark& landmark, KeyframeId keyframe, int change);
  void refresh_appearance(Landmark& landmark);

  std::map<KeyframeId, Keyframe> keyframes_;
  PagedIndex<Keyframe*, nullptr> keyframe_index_;  ///< into keyframes_, whose nodes stay where they are
  LandmarkStore landmarks_;
  std::map<KeyframeId, RemovedKeyframe> removed_;
  std::vector<LoopEdge> loops_;
  std::vector<KeyframeId> removed_order_;         ///< of those removed by this map, oldest first
  std::map<MapId, std::size_t> component_sizes_;  ///< keyframes
  MapId next_map_ = 0;
  KeyframeId next_keyframe_ = 0;
  LandmarkId next_landmark_ = 0;
};

/// A loop has tied `newer` to `older`: what it had become more uncertain by on the way is gone, and of the keyframes in
/// between the less is left the nearer they are to it. docs/theory/tracking.md, Eq. (14).
void spread_certainty(Map& map, KeyframeId older, KeyframeId newer);

/// By the keyframes that see it.
UnmeasuredDepth unmeasured_depth(const Map& map, const Landmark& landmark);

}  // namespace rtd::slam
