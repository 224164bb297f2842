// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/msg/ros.hpp"
#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// The transforms (tf) of a recording, and the camera's true path in them: TUM's bags contain the motion capture as
/// /world -> /kinect and the mounting below it down to the frame of the colour image.
class TransformLog {
 public:
  void add(const msg::TFMessage& message);
  /// T_world_camera at each measurement of the transform that begins at `world`; the transforms below are taken as they
  /// were nearest in time. Empty when no chain leads from `world` to `camera_frame`: odometry is not ground truth.
  geometry::Trajectory world_poses(const std::string& camera_frame) const;

 private:
  /// A frame below its parent.
  struct Link {
    std::string parent;
    std::map<std::int64_t, Eigen::Isometry3d> T_parent_child;  ///< by stamp, ns
    Eigen::Isometry3d at(std::int64_t stamp_ns) const;
  };
  std::map<std::string, Link> links_;  ///< by child
};

}  // namespace rtd::camera
