// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <vector>

#include "services/slam/core/map/map.hpp"
#include "services/slam/core/optimize/pose_graph.hpp"

namespace rtd::slam {

/// The pose graph of one component with the keyframes behind its nodes (ascending).
struct EssentialGraph {
  PoseGraph graph;
  std::vector<KeyframeId> keyframes;
};

/// What is known of the motion between two keyframes that share so many landmarks; 0: two maps were joined there.
/// docs/theory/loop_closing.md Eq. (6).
PoseGraphEdge motion_edge(std::uint32_t from, std::uint32_t to, const Eigen::Isometry3d& T_from_to,
                          int shared_landmarks);

/// Spanning tree, strong covisibility and loops of one component; the motions of the first two are those that the map
/// has now. The first keyframe is held. docs/theory/loop_closing.md, "Essential graph". Loops with removed
/// keyframes go to the closest remaining ancestors of those.
EssentialGraph make_essential_graph(const Map& map, MapId component);

/// Moves keyframes to new poses; landmarks follow their reference keyframe.
using KeyframePoses = std::map<KeyframeId, Eigen::Isometry3d>;  ///< T_world_camera
void move_keyframes(Map& map, const KeyframePoses& poses);

/// Moves a component as a whole: T_world_new = T_new_old * T_world_old.
void move_component(Map& map, MapId component, const Eigen::Isometry3d& T_new_old);

}  // namespace rtd::slam
