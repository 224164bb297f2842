// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "common/msg/ros.hpp"
#include "common/service/mount.hpp"

namespace rtd::slam {

/// The robot's own frame (REP 105, `base_link`: x forward, z up) and where the camera sits in it.
struct RobotBase {
  std::string frame;                                                ///< name on the wire
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();  ///< of the optical frame of the camera
  bool publish_camera = true;                                       ///< tf also carries base -> camera
};

/// Of a camera that looks horizontally, in axes of its own with x forward and z up.
Eigen::Isometry3d level_camera();
using service::parse_mount;

/// A pose of the camera becomes that of the base.
void move_to_base(msg::PoseStamped& pose, const RobotBase& base);
/// Pose and twist of the camera become those of the base, with their covariances (docs/frames.md).
void move_to_base(msg::Odometry& odometry, const RobotBase& base);
/// odom -> camera becomes odom -> base and, if wanted, base -> camera.
void move_to_base(msg::TFMessage& tf, const RobotBase& base);

}  // namespace rtd::slam
