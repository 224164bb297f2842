// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/msg/fields.hpp"
#include "common/msg/tracking.hpp"

namespace rtd::msg {

/// Bits of MapKeyframe::content: what an entry says besides the pose.
enum MapContent : std::uint32_t {
  kMapPoints = 1U << 0,   ///< points_m replaces the points of the keyframe
  kMapEdges = 1U << 1,    ///< covisible replaces its edges
  kMapRemoved = 1U << 2,  ///< the keyframe is gone; nothing else of the entry counts
};

/// What changed about one keyframe. Its pose always counts, the rest where `content` says so.
struct MapKeyframe {
  std::uint32_t keyframe_id = 0;
  std::uint32_t map_id = 0;  ///< map that it belongs to: each has its own world frame until merged
  std::int64_t stamp_ns = 0;
  Transform T_world_camera{};
  std::uint32_t content = 0;             ///< MapContent bits
  std::vector<float> points_m;           ///< x y z of each landmark in the camera frame of this keyframe, m
  std::vector<std::uint32_t> covisible;  ///< keyframe ids; each edge is listed once, by its younger keyframe
};
RTD_FIELDS(rtd_msgs, MapKeyframe, keyframe_id, map_id, stamp_ns, T_world_camera, content, points_m, covisible)
inline const char* broken_rule(const MapKeyframe& keyframe) {
  const bool removed = (keyframe.content & kMapRemoved) != 0;
  if (!removed && !is_rotation(keyframe.T_world_camera.rotation_xyzw)) return "T_world_camera";
  return keyframe.points_m.size() % 3 == 0 ? nullptr : "points_m";
}

/// What changed in the map since the last update: topic `rtd/map`, from slam to viewers. Points lie in the frames of
/// their keyframes, so that a corrected map costs poses only. Each landmark belongs to one keyframe.
struct MapUpdate {
  std::int64_t session_ns =
      0;                       ///< a new value: the map was reset or replaced, or messages were lost: forget all before
  std::uint64_t revision = 0;  ///< counts the updates of a session from 1
  std::vector<MapKeyframe> keyframes;
  std::vector<std::uint32_t> loop_edges;  ///< all closed loops: pairs of keyframe ids, older and newer
};
RTD_FIELDS(rtd_msgs, MapUpdate, session_ns, revision, keyframes, loop_edges)
inline const char* broken_rule(const MapUpdate& update) {
  return update.loop_edges.size() % 2 == 0 ? nullptr : "loop_edges";
}

}  // namespace rtd::msg
