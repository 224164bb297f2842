// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/vision/pose_optimizer.hpp"
#include "services/slam/core/map/landmark.hpp"
#include "services/slam/core/map/local_map.hpp"

namespace rtd::slam {

using Clock = std::function<std::int64_t()>;  ///< ns, monotonic; injected
inline float to_ms(std::int64_t duration_ns) {
  return static_cast<float>(static_cast<double>(duration_ns) * 1e-6);
}

/// A frame whose pose is known, with the landmarks found in it.
struct TrackedFrame {
  FramePtr frame;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<LandmarkId> landmarks;  ///< per feature
  KeyframeId reference = kNoKeyframe;
  Eigen::Isometry3d T_reference_camera = Eigen::Isometry3d::Identity();
};

/// The outcome of one step of tracking. `landmarks` are the inliers of `T_world_camera`.
struct PoseGuess {
  bool success = false;
  bool guided = true;  ///< by the motion; else by descriptors alone
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<LandmarkId> landmarks;  ///< per feature
  int witnesses = 0;                  ///< of the inliers
  double probation_weight = 1;        ///< factor on the weights of all that are no witnesses
  int inliers = 0;                    ///< landmarks, without temporary points
  int points = 0;                     ///< with them
  std::int64_t optimizer_ns = 0;      ///< spent in pose optimisation
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
  geometry::Matrix6d image_covariance = geometry::Matrix6d::Zero();  ///< without what a gyroscope adds
};

/// A feature of the frame with the world point it is taken for.
struct Association {
  std::uint32_t feature = 0;
  LandmarkId landmark = kNoLandmark;  ///< kNoLandmark: a temporary point
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  double static_probability = 1.0;
  bool witness = false;     ///< Landmark::witness
  bool in_question = true;  ///< Landmark::in_question; a temporary point is no more known than its feature
  UnmeasuredDepth unmeasured = {};
};

/// What the steps need besides frame and map.
struct TrackingContext {
  const SlamConfig& config;
  const Clock& now_ns;
  std::optional<vision::RotationPrior> rotation = {};  ///< of the frame, by a gyroscope
  std::optional<vision::PositionPrior> position = {};  ///< of the frame, by the last motion
};

/// Where the camera is looked for.
struct ExpectedPose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::optional<double> radius_px = {};  ///< how far from there a landmark may be seen; else by the time that passed
};

/// Frame to frame: looks for the landmarks of the last frame, and for its close features as temporary points, around
/// where `expected` shows them. docs/theory/tracking.md, "Motion model".
PoseGuess track_last_frame(const Frame& frame, const TrackedFrame& last, const LocalMap& map,
                           const ExpectedPose& expected, const TrackingContext& context);

/// Frame to frame without a map: as track_last_frame(), and features of the last frame without depth count as far away,
/// which shows how the camera has turned. docs/theory/tracking.md, "Odometry".
PoseGuess track_motion(const Frame& frame, const TrackedFrame& last, const LocalMap& map, const ExpectedPose& expected,
                       const TrackingContext& context);

/// Frame to keyframe by descriptors alone, pose by RANSAC: after a jump or a loss. "Recovery".
PoseGuess track_keyframe(const Frame& frame, const LocalKeyframe& keyframe, const LocalMap& map,
                         const TrackingContext& context);

/// Frame to local map without a guess: looks for every landmark of the local map as far around `expected` as the camera
/// may have turned since the last frame; when hardly any landmark of the last frame is still in view, because something
/// covers them now.
PoseGuess track_around(const Frame& frame, const TrackedFrame& last, const LocalMap& map, const ExpectedPose& expected,
                       const TrackingContext& context);

/// Frame to local map: looks for every landmark of the local map that should be visible from `guess`, and optimises
/// the pose with all of them.
struct LocalMapTracking {
  PoseGuess guess;
  std::vector<LandmarkId> visible;    ///< landmarks that should be seen from the pose
  std::vector<Association> rejected;  ///< matched, but the pose does not agree
};
LocalMapTracking track_local_map(const Frame& frame, const LocalMap& map, const PoseGuess& guess,
                                 const TrackingContext& context);

/// Frame to a recognised place: track_keyframe() with its centre, then twice track_local_map(), because from a coarse
/// pose many landmarks are missed. Empty when one of the first two fails.
std::optional<LocalMapTracking> track_place(const Frame& frame, const LocalMap& place, const TrackingContext& context);
/// The same from a first guess of the pose.
std::optional<LocalMapTracking> track_place_from(const Frame& frame, const LocalMap& place, const PoseGuess& start,
                                                 const TrackingContext& context);

}  // namespace rtd::slam
