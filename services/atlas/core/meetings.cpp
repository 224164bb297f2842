// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Where the maps of robots meet, and the joint map that follows: docs/atlas.md.
#include <algorithm>

#include "common/geometry/se3.hpp"
#include "services/atlas/core/atlas.hpp"
#include "services/slam/core/loop/essential_graph.hpp"

namespace rtd::atlas {

using slam::Keyframe;
using slam::kNoKeyframe;

std::optional<slam::PlaceMeeting> Atlas::meet(const std::string& name, const Robot& robot, KeyframeId keyframe) {
  const MapId here = world_of(keyframe);
  const auto admitted = [&](KeyframeId id) { return sources_.at(id).robot != name || world_of(id) != here; };
  for (const slam::PlaceCandidate& candidate :
       slam::find_like_places(map_, places_, keyframe, config_.slam.loop, admitted)) {
    auto meeting = slam::meet_place(map_, *map_.find_keyframe(keyframe)->frame, candidate.keyframe, config_.slam);
    if (!meeting) continue;
    ++counters_.met;
    if (is_plausible(robot, keyframe, *meeting)) return meeting;
    ++counters_.implausible;
  }
  return std::nullopt;
}

/// Between two worlds nothing is known. In one, the correction must be one that drift since the last meeting explains.
bool Atlas::is_plausible(const Robot& robot, KeyframeId id, const slam::PlaceMeeting& meeting) const {
  if (world_of(id) != world_of(meeting.place)) return true;
  const Eigen::Isometry3d T = map_.find_keyframe(id)->T_world_camera.inverse() * meeting.T_world_camera;
  const double way_m = robot.way_m - robot.way_at_meeting_m;
  const slam::LoopConfig& loop = config_.slam.loop;
  return T.translation().norm() <= loop.max_offset_m + loop.max_drift_ratio * way_m &&
         geometry::rotation_angle_rad(T) <= loop.max_offset_rad + loop.max_drift_rad_m * way_m;
}

void Atlas::look_for_meeting(const std::string& name, Robot& robot, KeyframeId id) {
  const bool met = robot.meetings > 0 && is_joined(id);
  if (met && robot.agreement.empty() && ++robot.since_look < config_.look_every) return;
  robot.since_look = 0;
  const std::optional<slam::PlaceMeeting> meeting = meet(name, robot, id);
  if (!meeting) {
    robot.agreement.miss(config_.slam.loop);
    if (robot.agreement.empty()) robot.agreeing.clear();
    return;
  }
  const Keyframe& keyframe = *map_.find_keyframe(id);
  const std::array<MapId, 2> worlds{world_of(id), world_of(meeting->place)};
  const Eigen::Isometry3d T_new_old = meeting->T_world_camera * keyframe.T_world_camera.inverse();
  const bool agreed =
      robot.agreement.add(T_new_old, keyframe.T_world_camera, worlds == robot.agreeing_worlds, config_.slam.loop);
  if (!agreed && robot.agreement.confirmations() == 1) robot.agreeing.clear();
  robot.agreeing_worlds = worlds;
  const Eigen::Isometry3d T_world_place = map_.find_keyframe(meeting->place)->T_world_camera;
  robot.agreeing.push_back({meeting->place, id, T_world_place.inverse() * meeting->T_world_camera});
  if (agreed) accept(name, robot, T_new_old);
}

void Atlas::accept(const std::string& name, Robot& robot, const Eigen::Isometry3d& T_new_old) {
  ++last_meeting_;
  for (Meeting& meeting : robot.agreeing) {
    if (map_.find_keyframe(meeting.place) == nullptr || map_.find_keyframe(meeting.keyframe) == nullptr) continue;
    meeting.number = last_meeting_;
    meetings_.push_back(meeting);
  }
  robot.agreeing.clear();
  robot.way_at_meeting_m = robot.way_m;
  ++robot.meetings;
  ++counters_.meetings;
  const auto [here, there] = robot.agreeing_worlds;
  if (there < here) join_worlds(there, here, T_new_old);
  if (here < there) join_worlds(here, there, T_new_old.inverse());
  crooked_[std::min(here, there)] = name;
}

void Atlas::join_worlds(MapId kept, MapId joined, const Eigen::Isometry3d& T_kept_joined) {
  for (auto& [component, world] : worlds_) {
    if (world != joined) continue;
    slam::move_component(map_, component, T_kept_joined);
    world = kept;
  }
  crooked_.erase(joined);
  ++counters_.corrections;
  sort_into_cells();
}

/// As the robot that made both has it; empty where nobody knows it.
std::optional<Eigen::Isometry3d> Atlas::motion_by_robot(KeyframeId from, KeyframeId to) const {
  const Source& source = sources_.at(to);
  const auto robot = robots_.find(source.robot);
  if (robot == robots_.end()) return std::nullopt;
  const Announced *a = nullptr, *b = nullptr;
  const auto& known = robot->second.keyframes;
  if (const auto it = known.find(source.id); it != known.end() && it->second.keyframe == to) b = &it->second;
  // The other one is of the same robot, or of the map that it was given.
  const Source& other = sources_.at(from);
  for (const KeyframeId id : {other.robot == source.robot ? other.id : from, from})
    if (const auto it = known.find(id); it != known.end() && it->second.keyframe == from) a = &it->second;
  if (a == nullptr || b == nullptr || a->map != b->map) return std::nullopt;
  return a->T_robot_camera.inverse() * b->T_robot_camera;
}

slam::PoseGraph Atlas::make_graph(MapId world, std::vector<KeyframeId>& nodes) const {
  slam::PoseGraph graph;
  std::map<KeyframeId, std::uint32_t> index;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    if (worlds_.at(keyframe.map) != world) continue;
    index[id] = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(id);
    graph.nodes.push_back({keyframe.T_world_camera, nodes.size() == 1});
  }
  const auto add_motion = [&](KeyframeId from, KeyframeId to, int shared) {
    const Eigen::Isometry3d T_present =
        map_.find_keyframe(from)->T_world_camera.inverse() * map_.find_keyframe(to)->T_world_camera;
    graph.edges.push_back(slam::motion_edge(index.at(from), index.at(to), motion_by_robot(from, to).value_or(T_present),
                                            std::max(shared, 1)));
  };
  constexpr int kStrong = 100;  // landmarks in common
  for (const KeyframeId id : nodes) {
    const Keyframe& keyframe = *map_.find_keyframe(id);
    if (!keyframe.is_origin()) {
      const auto shared = keyframe.covisible.find(keyframe.parent);
      add_motion(keyframe.parent, id, shared == keyframe.covisible.end() ? 0 : shared->second);
    }
    for (const auto& [other, shared] : keyframe.covisible)
      if (other < id && other != keyframe.parent && shared >= kStrong) add_motion(other, id, shared);
  }
  for (const Meeting& meeting : meetings_)
    if (index.contains(meeting.place) && index.contains(meeting.keyframe))
      graph.edges.push_back(
          slam::meeting_edge(index.at(meeting.place), index.at(meeting.keyframe), meeting.T_place_keyframe));
  return graph;
}

/// Whether motions of other robots are no longer what those measured.
bool Atlas::bends_others(const slam::PoseGraph& graph, const std::vector<KeyframeId>& nodes,
                         const std::string& robot) const {
  return std::ranges::any_of(graph.edges, [&](const slam::PoseGraphEdge& edge) {
    if (sources_.at(nodes[edge.from]).robot == robot || sources_.at(nodes[edge.to]).robot == robot) return false;
    const Eigen::Isometry3d T_now = graph.nodes[edge.from].T_world_node.inverse() * graph.nodes[edge.to].T_world_node;
    const double bend_m = (T_now.translation() - edge.T_from_to.translation()).norm();
    return bend_m > config_.most_bend_m + config_.most_bend_share * edge.T_from_to.translation().norm();
  });
}

/// The last one of a robot; false when it has none.
bool Atlas::take_back_meeting(const std::string& robot) {
  const auto last = std::ranges::find_if(meetings_.rbegin(), meetings_.rend(), [&](const Meeting& meeting) {
    return sources_.at(meeting.keyframe).robot == robot;
  });
  if (last == meetings_.rend()) return false;
  const std::uint64_t number = last->number;
  std::erase_if(meetings_, [&](const Meeting& meeting) { return meeting.number == number; });
  ++counters_.refused;
  return true;
}

/// `robot` is the cause. What it says must not bend the maps of others: else its last meeting is taken back.
bool Atlas::straighten_world(MapId world, const std::string& robot) {
  slam::PoseGraphOptions options;
  options.max_iterations = config_.slam.loop.graph_iterations;
  do {
    std::vector<KeyframeId> nodes;
    slam::PoseGraph graph = make_graph(world, nodes);
    if (nodes.empty() || !slam::optimize_pose_graph(graph, options).usable) return false;
    if (bends_others(graph, nodes, robot)) continue;
    slam::KeyframePoses poses;
    for (std::size_t i = 0; i < nodes.size(); ++i) poses[nodes[i]] = graph.nodes[i].T_world_node;
    slam::move_keyframes(map_, poses);
    return true;
  } while (take_back_meeting(robot));
  return false;
}

bool Atlas::straighten() {
  bool moved = false;
  for (const auto& [world, robot] : std::exchange(crooked_, {})) moved = straighten_world(world, robot) || moved;
  if (!moved) return false;
  ++counters_.corrections;
  sort_into_cells();
  return true;
}

}  // namespace rtd::atlas
