// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/map/map.hpp"
#include "services/slam/core/optimize/bundle_adjustment.hpp"

namespace rtd::slam {

/// Features that become landmarks from their own depth: all nearer than `close_depth_m`, and at least the 100 nearest.
/// Only those without a landmark are returned; those with one count towards the 100.
std::vector<std::uint32_t> select_close_features(const Frame& frame, const std::vector<LandmarkId>& landmarks,
                                                 double close_depth_m);

/// Makes landmarks of the keyframe's close features that have none. Returns the new ones.
std::vector<LandmarkId> create_from_depth(Map& map, KeyframeId keyframe, double close_depth_m);

/// Where the keyframe has few landmarks and hardly any depth, makes landmarks of features that are too far for the
/// depth sensor, at an assumed distance. docs/theory/mapping.md, "Beyond the sensor's range". Returns the new ones.
std::vector<LandmarkId> create_beyond_range(Map& map, KeyframeId keyframe);

/// Makes landmarks that two views agree on, from features of the keyframe and of its best covisible ones that have no
/// landmark yet: epipolar search, triangulation (or depth, where it is the better of the two), checks of
/// depth, reprojection and scale. docs/theory/mapping.md Eq. (4)-(6). Nothing is made nearer than `close_depth_m`
/// without a depth, unless the sensor measures hardly any. Returns the new ones.
std::vector<LandmarkId> create_by_triangulation(Map& map, KeyframeId keyframe, int neighbours, double close_depth_m);

/// The point nearest to two rays in the linear least squares sense, p_world; empty when they are parallel. Normalised
/// image coordinates.
std::optional<Eigen::Vector3d> triangulate(const Eigen::Isometry3d& T_camera_world_1, const Eigen::Vector2d& n1,
                                           const Eigen::Isometry3d& T_camera_world_2, const Eigen::Vector2d& n2);

/// Joins landmarks that are the same point seen twice: projects the landmarks of the keyframe into its neighbours and
/// theirs into it; a feature found there becomes an observation, or, if it has its own landmark, the landmark
/// with fewer observations is removed. docs/theory/mapping.md, "Fusion". Returns how many landmarks were merged.
int fuse_landmarks(Map& map, KeyframeId keyframe, int neighbours);

/// The same for chosen landmarks and one keyframe that may see them.
int fuse_into(Map& map, KeyframeId target, const std::vector<LandmarkId>& landmarks);

/// What these keyframes see, ascending.
std::vector<LandmarkId> landmarks_of(const Map& map, const std::vector<KeyframeId>& keyframes);

/// Landmarks on probation: made by the last keyframes, kept only if tracking finds them again.
class RecentLandmarks {
 public:
  void add(const std::vector<LandmarkId>& landmarks);
  /// Removes those that are found too rarely or that too few keyframes confirm; those that lasted three keyframes
  /// leave probation. docs/theory/mapping.md, "Culling". Returns how many were removed.
  int cull(Map& map, KeyframeId newest, double min_found_ratio);
  std::size_t size() const { return landmarks_.size(); }

 private:
  std::vector<LandmarkId> landmarks_;
};

/// Covisible keyframes of the newest one that are checked for redundancy.
inline constexpr std::size_t kMaxRedundancyCandidates = 30;

/// Whether nearly all landmarks of a keyframe (`redundant_ratio`; `old_redundant_ratio` when it is old at the time
/// `now_ns` of the newest frame) are seen by at least three others at the same or a finer scale. Never true for the
/// first keyframe of a map.
bool is_redundant_keyframe(const Map& map, KeyframeId keyframe, std::int64_t now_ns, const MapperConfig& config);

/// Bundle adjustment of the newest keyframe, its best covisible ones and all landmarks they see; older keyframes that
/// see these landmarks are fixed. Outlier observations are taken out of the map. docs/theory/mapping.md, "Local bundle
/// adjustment". `interrupted` may end it early. Returns the keyframes that moved.
std::vector<KeyframeId> adjust_local_map(Map& map, KeyframeId newest, const MapperConfig& config,
                                         const std::function<bool()>& interrupted);

/// Gives the camera of each keyframe the intrinsics that its frame was seen with, but BundleProblem::camera's weight of
/// depth: the newest frame knows the sensor best.
void set_intrinsics(const Map& map, const std::vector<KeyframeId>& keyframes, BundleProblem& bundle);

/// One observation of a landmark as bundle adjustment weighs it.
BundleObservation bundle_observation(const Keyframe& keyframe, std::uint32_t feature, const Landmark& landmark,
                                     std::uint32_t camera, std::uint32_t point);

}  // namespace rtd::slam
