// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/msg/tracking.hpp"

namespace rtd::eval {

/// What was published of one frame, at the time: later corrections of the map do not count.
struct PublishedPose {
  std::int64_t stamp_ns = 0;
  msg::TrackingState state = msg::TrackingState::kInitializing;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< where msg::has_pose(state)
  std::optional<geometry::Matrix6d> covariance;  ///< (x y z rx ry rz), m and rad, world frame; none: not known
  std::uint32_t map_id = 0;                      ///< poses of different maps are not compared
};

/// A covariance of zeros, as in run.json, or of a pose that slam calls unknown, is none. A pose that is none, or a
/// state that this version does not know, makes the frame a lost one.
PublishedPose published_pose(const msg::TrackingResult& result);

/// The poses measured in the first map; those whose stamps do not increase are left out.
geometry::Trajectory measured_poses(const std::vector<PublishedPose>& published);

}  // namespace rtd::eval
