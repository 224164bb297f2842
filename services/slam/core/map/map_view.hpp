// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// A keyframe as viewers show it.
struct KeyframeView {
  KeyframeId id = kNoKeyframe;
  MapId map = 0;
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<LandmarkId> landmarks;  ///< those whose reference it is, ascending: each landmark belongs to one keyframe
  std::vector<Eigen::Vector3f> points_m;  ///< p_camera of each of them, m
  std::vector<KeyframeId> covisible;      ///< its parent and older keyframes that see much of the same, ascending
};

/// A copy of what viewers show of a whole map.
struct MapView {
  std::uint64_t session = 0;            ///< counts the maps of this process that replaced one another
  std::vector<KeyframeView> keyframes;  ///< by id
  std::vector<KeyframeId> loop_edges;   ///< older and newer keyframe of each closed loop that are still in the map
};

/// Calls its argument with the map while no other thread changes it.
using ReadMap = std::function<void(const std::function<void(const Map&)>&)>;

/// Copies the map in portions of a few milliseconds, so that the mapper never waits longer. What changes meanwhile may
/// be seen half: each keyframe and each landmark fits itself and its reference, the next copy has the rest.
MapView copy_view(const ReadMap& read);

}  // namespace rtd::slam
