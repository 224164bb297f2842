// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/geometry/se3.hpp"
#include "services/slam/core/slam_config.hpp"

namespace rtd::slam {

/// How the camera moved when it was last measured.
struct CameraMotion {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  geometry::Vector6d velocity_per_s = geometry::Vector6d::Zero();  ///< twist in the camera's frame, m/s and rad/s
  double velocity_gap_s = 0;                                       ///< time between the two poses that it is from
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();      ///< of the pose, (x y z rx ry rz), world frame
};

/// A pose that nothing was measured for.
struct PredictedPose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  ///< grows with time: (x y z rx ry rz), world frame
};

/// The pose `gap_s` after the last measured one: the velocity fades, the doubt grows. docs/theory/tracking.md Eq.
/// (10), (11).
PredictedPose predict_motion(const CameraMotion& motion, double gap_s, const PredictionConfig& config);

/// Squared Mahalanobis distance between two estimates of one pose.
double pose_distance2(const PredictedPose& a, const PredictedPose& b);

}  // namespace rtd::slam
