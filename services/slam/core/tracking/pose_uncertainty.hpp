// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/map/local_map.hpp"
#include "services/slam/core/map/trajectory.hpp"

namespace rtd::slam {

/// How the camera moved when it was last measured.
struct CameraMotion {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  geometry::Vector6d velocity_per_s = geometry::Vector6d::Zero();  ///< twist in the camera's frame, m/s and rad/s
  double velocity_gap_s = 0;                                       ///< time between the two poses that it is from
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();      ///< of the pose, (x y z rx ry rz), world frame
};

inline constexpr double kMaxPredictionGap_s = 0.5;  ///< nothing is known of the motion over a longer gap

/// Where a camera is that has gone `T_last_camera` in `gap_s`, seen from where it would be at constant velocity.
Eigen::Isometry3d off_motion(const CameraMotion& motion, const Eigen::Isometry3d& T_last_camera, double gap_s);

/// Whether a camera that moved like `motion` can have got there in `gap_s`. If not, frames in between are missing or it
/// was carried away, and the distance over the gap is not its velocity.
bool is_steady(const CameraMotion& motion, const Eigen::Isometry3d& T_last_camera, double gap_s);

/// The pose `gap_s` after the last measured one: the velocity fades, the doubt grows. docs/theory/tracking.md Eq.
/// (10), (11).
PredictedPose predict_motion(const CameraMotion& motion, double gap_s, const PredictionConfig& config);

/// 99 % of chi2 with 6 degrees of freedom.
inline constexpr double kMaxPoseDistance2 = 16.8;
/// Squared Mahalanobis distance between two estimates of one pose.
double pose_distance2(const PredictedPose& a, const PredictedPose& b);

/// What a camera whose focal length, principal point and depth may be off by a share adds to the covariance of a pose,
/// (x y z rx ry rz) in the world frame: every way and turn from the origin of the map is wrong by that share, in an
/// unknown direction, and a wrong turn looks like a way across a scene at `scene_m`.
/// docs/theory/tracking.md Eq. (15).
geometry::Matrix6d calibration_covariance(const Eigen::Isometry3d& T_world_camera, double scene_m, double share);

/// How uncertain the map itself is where the camera is, docs/theory/tracking.md Eq. (13), (14): a landmark is as
/// uncertain as the keyframe that found it first, a keyframe as uncertain as what it was tracked by and its own pose
/// against it (Keyframe::covariance). Covariances are of (x y z rx ry rz) in the world frame.
class MapUncertainty {
 public:
  /// Covariance in the world of a pose that was measured against these landmarks (per feature) with `local`.
  geometry::Matrix6d in_world(const geometry::Matrix6d& local, const Eigen::Vector3d& position,
                              const std::vector<LandmarkId>& landmarks, const LocalMap& map);

 private:
  geometry::Matrix6d of_landmarks(const Eigen::Vector3d& position, const std::vector<LandmarkId>& landmarks,
                                  const LocalMap& map) const;

  /// Of keyframes that have none: a map that begins, or was loaded, is the world, by measurements that are no better
  /// than the first ones against it.
  geometry::Matrix6d of_origin_ = geometry::Matrix6d::Zero();
  std::optional<MapId> map_;  ///< that `of_origin_` is from
};

}  // namespace rtd::slam
