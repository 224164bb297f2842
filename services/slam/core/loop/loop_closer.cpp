// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/loop_closer.hpp"

#include "common/geometry/se3.hpp"
#include "services/slam/core/loop/essential_graph.hpp"
#include "services/slam/core/loop/loop_detector.hpp"

namespace rtd::slam {
namespace {

LoopEdge make_edge(const Map& map, const Loop& loop) {
  const Eigen::Isometry3d T_place_camera =
      map.find_keyframe(loop.meeting.place)->T_world_camera.inverse() * loop.meeting.T_world_camera;
  if (loop.meeting.place < loop.keyframe)
    return {loop.meeting.place, loop.keyframe, T_place_camera, loop.meeting.inliers};
  return {loop.keyframe, loop.meeting.place, T_place_camera.inverse(), loop.meeting.inliers};
}

/// The oldest keyframe of a component: its origin.
KeyframeId origin_of(const Map& map, MapId component) {
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (keyframe.map == component && keyframe.is_origin()) return id;
  }
  return kNoKeyframe;
}

/// The newest keyframe of a component that is older than `id`.
KeyframeId newest_before(const Map& map, MapId component, KeyframeId id) {
  KeyframeId newest = kNoKeyframe;
  for (const auto& [other, keyframe] : map.keyframes()) {
    if (keyframe.map == component && other < id) newest = other;
  }
  return newest;
}

}  // namespace

std::optional<LoopClosure> LoopCloser::close(Map& map, const KeyframeDatabase& places, KeyframeId newest) {
  const std::optional<Loop> loop = detector_.detect(map, places, newest);
  const Keyframe* const keyframe = map.find_keyframe(newest);
  if (!loop || keyframe == nullptr) return std::nullopt;
  const Eigen::Vector3d before = keyframe->T_world_camera.translation();
  const bool two_maps = keyframe->map != map.find_keyframe(loop->meeting.place)->map;
  LoopClosure closure;
  closure.edge = make_edge(map, *loop);
  closure.older_ns = map.find_keyframe(closure.edge.older)->frame->stamp_ns;
  closure.newer_ns = map.find_keyframe(closure.edge.newer)->frame->stamp_ns;
  closure.merged = two_maps;
  map.add_loop(closure.edge);
  if (two_maps) {
    closure.map = merge(map, *loop);
  } else {
    closure.map = map.find_keyframe(newest)->map;
    straighten(map, closure.map);
  }
  closure.correction_m = (map.find_keyframe(newest)->T_world_camera.translation() - before).norm();
  closure.joined = fuse_place(map, newest, loop->meeting, config_.mapper.neighbours);
  detector_.forget();
  return closure;
}

/// Lets the drift go into all keyframes of the loop.
void LoopCloser::straighten(Map& map, MapId component) {
  EssentialGraph essential = make_essential_graph(map, component);
  PoseGraphOptions options;
  options.max_iterations = config_.loop.graph_iterations;
  if (!optimize_pose_graph(essential.graph, options).usable) return;
  KeyframePoses poses;
  for (std::size_t i = 0; i < essential.keyframes.size(); ++i) {
    poses[essential.keyframes[i]] = essential.graph.nodes[i].T_world_node;
  }
  move_keyframes(map, poses);
}

/// Moves the younger map to where the loop puts it and makes it part of the older one.
MapId LoopCloser::merge(Map& map, const Loop& loop) {
  const Keyframe& keyframe = *map.find_keyframe(loop.keyframe);
  const MapId own = keyframe.map, met = map.find_keyframe(loop.meeting.place)->map;
  const Eigen::Isometry3d T_met_own =
      geometry::normalized(loop.meeting.T_world_camera * keyframe.T_world_camera.inverse());
  const MapId older = std::min(own, met), younger = std::max(own, met);
  move_component(map, younger, younger == own ? T_met_own : T_met_own.inverse());
  map.join_components(younger, newest_before(map, older, origin_of(map, younger)));
  return older;
}

}  // namespace rtd::slam
