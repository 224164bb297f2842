// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/trajectory.hpp"
#include "common/msg/ros.hpp"

namespace rtd::geometry {

/// tf of old wrote frames with a slash in front: "/kinect" -> "kinect".
std::string bare_frame(const std::string& frame);

/// T_parent_child of a transform; empty when it is not a rotation or not finite.
std::optional<Eigen::Isometry3d> to_isometry(const msg::RosTransform& transform);

/// The transforms (tf) of a robot or a camera. Not thread-safe.
class TransformLog {
 public:
  void add(const msg::TFMessage& message);
  /// T_world_camera at each measurement of the transform that begins at `world`; the transforms below are taken as they
  /// were nearest in time (TUM's bags contain the motion capture as /world -> /kinect and the mounting below it down to
  /// the frame of the colour image). Empty when no chain leads from `world` to `camera_frame`: odometry is not ground
  /// truth.
  Trajectory world_poses(const std::string& camera_frame) const;
  /// The same at one moment, between two measurements that are no farther away than `max_gap_ns`; empty without.
  std::optional<Eigen::Isometry3d> world_pose(const std::string& camera_frame, std::int64_t stamp_ns,
                                              std::int64_t max_gap_ns) const;
  /// T_target_source by the newest transforms; empty when no chain joins the two frames.
  std::optional<Eigen::Isometry3d> between(const std::string& target, const std::string& source) const;
  /// The frame that all transforms above `frame` lead to, and T_root_frame; the frame itself without any.
  std::pair<std::string, Eigen::Isometry3d> root_of(const std::string& frame) const;
  /// Whether a transform begins or ends at this frame.
  bool knows(const std::string& frame) const;
  /// All of these, sorted.
  std::set<std::string> frames() const;

 private:
  /// A frame below its parent.
  struct Link {
    std::string parent;
    std::map<std::int64_t, Eigen::Isometry3d> T_parent_child;  ///< by stamp, ns
    Eigen::Isometry3d at(std::int64_t stamp_ns) const;
  };
  /// A frame above another one.
  struct Above {
    std::string frame;
    Eigen::Isometry3d T_frame_start;
  };
  std::vector<Above> chain_from(const std::string& frame) const;
  std::vector<const Link*> chain_to_world(const std::string& camera_frame) const;
  static Eigen::Isometry3d T_child_camera(const std::vector<const Link*>& chain, std::int64_t stamp_ns);

  std::map<std::string, Link> links_;  ///< by child
};

}  // namespace rtd::geometry
