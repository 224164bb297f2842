// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/map/map.hpp"
#include "services/slam/core/place/keyframe_database.hpp"

namespace rtd::slam {

/// A keyframe found at a place that it has no landmarks in common with.
struct PlaceMeeting {
  KeyframeId place = kNoKeyframe;  ///< keyframe there that sees most of what was found
  Eigen::Isometry3d T_world_camera =
      Eigen::Isometry3d::Identity();  ///< of the keyframe, in the world of the place's landmarks
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  ///< of (x y z rx ry rz), m and rad, in that world
  std::vector<LandmarkId> landmarks;  ///< per feature of the keyframe: landmark of the place, kNoLandmark where none
  int inliers = 0;
  double found_share = 0;  ///< of the place's landmarks that should be visible from there
};

/// Looks for a place in a frame: descriptors, 3D-3D RANSAC, robust optimisation, then every landmark of the place
/// that should be visible is searched and the pose optimised with all of them, twice. Empty when that ends with
/// fewer than `min_inliers` landmarks or `min_found_share`. docs/theory/loop_closing.md, "Verification".
std::optional<PlaceMeeting> meet_place(const Map& map, const Frame& frame, KeyframeId candidate,
                                       const SlamConfig& config);
/// What a frame finds of a place from a pose that is known to about 0.1 m, however little; empty when that is no pose.
std::optional<PlaceMeeting> look_again(const Map& map, const Frame& frame, KeyframeId candidate,
                                       const Eigen::Isometry3d& T_world_camera, const SlamConfig& config);

/// Whether two corrections T_world_new = T_new_old T_world_old move a camera at T_old_camera to about the same place.
bool agree(const Eigen::Isometry3d& T_new_old, const Eigen::Isometry3d& other_T_new_old,
           const Eigen::Isometry3d& T_old_camera, const LoopConfig& config);

/// Whether a correction of a pose is one that drift on the way since can explain, docs/theory/loop_closing.md Eq. (1).
bool drift_explains(const Eigen::Isometry3d& T_old_new, double way_m, const LoopConfig& config);

/// Joins the landmarks of a keyframe and its neighbours with those of the place it was found at; both stand where they
/// belong already. First those that the meeting found, then by projection. Returns how many landmarks were joined or
/// gained an observation. docs/theory/loop_closing.md, "Fusion".
int fuse_place(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting, int neighbours);

/// Two parts of the map that are the same place, as the newest keyframe saw it.
struct Loop {
  KeyframeId keyframe = kNoKeyframe;
  PlaceMeeting meeting;
};

/// What became of the candidates so far; for diagnostics and tests.
struct LoopCounters {
  std::size_t candidates = 0;     ///< compared
  std::size_t met = 0;            ///< found by geometry
  std::size_t implausible = 0;    ///< of those, too far off for the way walked
  std::size_t contradictory = 0;  ///< of those, asking for another correction than the keyframe before
};

/// Finds out whether the newest keyframe is at a known place: candidates by words outside its covisible neighbourhood,
/// geometry, plausibility against the way walked, and agreement over several keyframes. docs/theory/loop_closing.md,
/// "Detection". Reads the map only; one thread.
class LoopDetector {
 public:
  explicit LoopDetector(const SlamConfig& config) : config_(config) {}

  /// The loop that the newest keyframe confirms, once enough keyframes agree.
  std::optional<Loop> detect(const Map& map, const KeyframeDatabase& places, KeyframeId newest);
  /// The map has been corrected: what was seen before is no hypothesis any more.
  void forget() { hypothesis_.reset(); }
  const LoopCounters& counters() const { return counters_; }

 private:
  /// A correction that the last keyframes agree on.
  struct Hypothesis {
    KeyframeId keyframe = kNoKeyframe, place = kNoKeyframe;  ///< the last that did
    Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();
    int confirmations = 0, misses = 0;
  };

  std::optional<PlaceMeeting> meet(const Map& map, const KeyframeDatabase& places, KeyframeId newest);
  bool plausible(const Map& map, KeyframeId newest, const PlaceMeeting& meeting) const;
  bool agrees(const Map& map, KeyframeId newest, const PlaceMeeting& meeting) const;

  SlamConfig config_;
  std::optional<Hypothesis> hypothesis_;
  LoopCounters counters_;
};

}  // namespace rtd::slam
