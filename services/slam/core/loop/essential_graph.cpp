// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/essential_graph.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::slam {
namespace {

/// Deviations of the motion between two neighbours that share `kStrong` landmarks: a part that is always there and one
/// that grows with the motion. Fewer landmarks carry less information. docs/theory/loop_closing.md Eq. (6).
constexpr double kSigmaM = 0.002, kSigmaPerM = 0.01;
constexpr double kSigmaRad = 0.0005, kSigmaPerRad = 0.02;
constexpr double kStrong = 100;
constexpr double kNothingKnown = 10;  ///< m, rad
/// A loop was measured over a whole neighbourhood of landmarks.
constexpr double kLoopSigmaM = 0.002, kLoopSigmaRad = 0.001;

class GraphBuilder {
 public:
  GraphBuilder(const Map& map, MapId component) : map_(map) {
    for (const auto& [id, keyframe] : map.keyframes()) {
      if (keyframe.map != component) continue;
      index_[id] = static_cast<std::uint32_t>(result_.keyframes.size());
      result_.keyframes.push_back(id);
      result_.graph.nodes.push_back({keyframe.T_world_camera, keyframe.is_origin()});
    }
  }

  void add_tree() {
    for (const KeyframeId id : result_.keyframes) {
      const Keyframe& keyframe = *map_.find_keyframe(id);
      if (!keyframe.is_origin()) add_present_motion(keyframe.parent, id, shared(keyframe, keyframe.parent));
    }
  }

  void add_covisibility() {
    for (const KeyframeId id : result_.keyframes) {
      const Keyframe& keyframe = *map_.find_keyframe(id);
      for (const auto& [other, count] : keyframe.covisible) {
        if (other < id && other != keyframe.parent && count >= kStrong) add_present_motion(other, id, count);
      }
    }
  }

  void add_loop(const LoopEdge& loop) {
    const VertexPose older = pose_of(loop.older), newer = pose_of(loop.newer);
    if (older.keyframe == newer.keyframe || !index_.contains(older.keyframe) || !index_.contains(newer.keyframe)) {
      return;
    }
    result_.graph.edges.push_back({index_.at(older.keyframe), index_.at(newer.keyframe),
                                   older.T_keyframe_camera * loop.T_older_newer * newer.T_keyframe_camera.inverse(),
                                   kLoopSigmaM, kLoopSigmaRad});
  }

  EssentialGraph take() { return std::move(result_); }

 private:
  /// Where a keyframe that exists or existed is: relative to one that exists.
  struct VertexPose {
    KeyframeId keyframe;
    Eigen::Isometry3d T_keyframe_camera;
  };
  VertexPose pose_of(KeyframeId id) const {
    const auto [ancestor, T_ancestor_camera] = map_.living_ancestor(id);
    return {ancestor, T_ancestor_camera};
  }
  static int shared(const Keyframe& keyframe, KeyframeId other) {
    const auto it = keyframe.covisible.find(other);
    return it == keyframe.covisible.end() ? 0 : it->second;
  }
  void add_present_motion(KeyframeId from, KeyframeId to, int shared_landmarks) {
    const Eigen::Isometry3d T_from_to =
        map_.find_keyframe(from)->T_world_camera.inverse() * map_.find_keyframe(to)->T_world_camera;
    result_.graph.edges.push_back(motion_edge(index_.at(from), index_.at(to), T_from_to, shared_landmarks));
  }

  const Map& map_;
  EssentialGraph result_;
  std::map<KeyframeId, std::uint32_t> index_;
};

}  // namespace

PoseGraphEdge motion_edge(std::uint32_t from, std::uint32_t to, const Eigen::Isometry3d& T_from_to,
                          int shared_landmarks) {
  if (shared_landmarks == 0)
    return {from, to, T_from_to, kNothingKnown, kNothingKnown};  // keeps the graph in one piece
  const double doubt = std::sqrt(kStrong / std::clamp<double>(shared_landmarks, 10.0, 4 * kStrong));
  const double sigma_m = kSigmaM + kSigmaPerM * T_from_to.translation().norm();
  const double sigma_rad = kSigmaRad + kSigmaPerRad * geometry::rotation_angle_rad(T_from_to);
  return {from, to, T_from_to, doubt * sigma_m, doubt * sigma_rad};
}

EssentialGraph make_essential_graph(const Map& map, MapId component) {
  GraphBuilder builder(map, component);
  builder.add_tree();
  builder.add_covisibility();
  for (const LoopEdge& loop : map.loops()) builder.add_loop(loop);
  return builder.take();
}

void move_keyframes(Map& map, const KeyframePoses& poses) {
  KeyframePoses changes;  // T_after_before
  for (const auto& [id, T_world_camera] : poses) {
    Keyframe& keyframe = *map.find_keyframe(id);
    changes[id] = T_world_camera * keyframe.T_world_camera.inverse();
    keyframe.T_world_camera = T_world_camera;
  }
  for (const LandmarkId id : map.landmark_ids()) {
    Landmark& landmark = *map.find_landmark(id);
    const auto change = changes.find(landmark.reference);
    if (change != changes.end()) landmark.position = change->second * landmark.position;
    map.refresh_geometry(id);
  }
}

void move_component(Map& map, MapId component, const Eigen::Isometry3d& T_new_old) {
  KeyframePoses poses;
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (keyframe.map == component) poses[id] = geometry::normalized(T_new_old * keyframe.T_world_camera);
  }
  move_keyframes(map, poses);
}

}  // namespace rtd::slam
