// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/msg/ros.hpp"
#include "common/service/mount.hpp"
#include "common/service/runtime.hpp"
#include "services/slam/config.hpp"

namespace rtd::slam {

/// The robot's own frame (REP 105, `base_link`: x forward, z up) and where the camera sits in it.
struct RobotBase {
  std::string frame;                                                ///< name on the wire
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();  ///< of the optical frame of the camera
  bool publish_camera = true;                                       ///< tf also carries base -> camera
};

/// Of a camera that looks horizontally, in its own axes with x forward and z up.
Eigen::Isometry3d level_camera();
using service::parse_mount;

/// A pose of the camera becomes that of the base.
void move_to_base(msg::PoseStamped& pose, const RobotBase& base);
/// Pose and twist of the camera become those of the base, with their covariances (docs/frames.md).
void move_to_base(msg::Odometry& odometry, const RobotBase& base);
/// odom -> camera becomes odom -> base and, if wanted, base -> camera.
void move_to_base(msg::TFMessage& tf, const RobotBase& base);

/// The camera in tf: its optical frame as the images name it, and the frame above it that nothing else is above. A
/// driver publishes on `rt/tf_static` where its optical frame is in its housing; tf allows each frame one parent, so
/// `odom` has to lead to the housing, or the two trees fall apart. One thread.
class CameraTree {
 public:
  struct Camera {
    std::string frame;
    /// With T_root_camera; empty where the optical frame itself has no parent, or the robot's base is configured.
    std::optional<RobotBase> root;
  };

  CameraTree(const ServiceConfig& config, service::Runtime& runtime);
  /// As known now. The first time it waits a moment for a camera that has not said yet how its frame is called.
  const Camera& camera();

 private:
  struct Transforms;

  void await_name() const;
  std::optional<RobotBase> find_root(const std::string& frame) const;

  const std::string configured_, map_, odom_;
  const bool base_given_;
  service::Runtime& runtime_;
  const std::shared_ptr<Transforms> transforms_;
  bus::Reader<msg::TFMessage> reader_;
  Camera camera_;
  std::uint64_t revision_ = 0;  ///< of the transforms that camera_ goes by
};

}  // namespace rtd::slam
