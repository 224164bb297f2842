// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What robots have, what of it is here, and what is wanted: docs/atlas.md.
#include <algorithm>
#include <ranges>

#include "common/geometry/se3.hpp"
#include "common/msg/stamps.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/atlas/core/atlas.hpp"

namespace rtd::atlas {

using slam::Keyframe;
using slam::kNoKeyframe;

/// Keyframes of one robot; no honest map has more.
static constexpr std::size_t kMostAnnounced = 100'000;

/// A correction by the robot of less than this does not show in the joint map.
static bool has_moved(const Eigen::Isometry3d& T_before, const Eigen::Isometry3d& T_now) {
  constexpr double kMoved_m = 0.01, kMoved_rad = 0.005;
  const Eigen::Isometry3d T = T_before.inverse() * T_now;
  return T.translation().norm() > kMoved_m || geometry::rotation_angle_rad(T) > kMoved_rad;
}

/// A keyframe that may be here already: of this robot, before its map or this process began again, or of the map that
/// the robot was given and that has the same ids. Robots in a simulation share a clock, so stamps alone prove nothing.
KeyframeId Atlas::find_known(const std::string& robot, KeyframeId id, std::int64_t stamp_ns) const {
  const auto [first, last] = by_stamp_.equal_range(stamp_ns);
  for (auto it = first; it != last; ++it)
    if (it->second == id || sources_.at(it->second).robot == robot) return it->second;
  return kNoKeyframe;
}

/// When a keyframe was seen, by the clock of follow(). What was restored counts by the clock that its robot has now.
double Atlas::seen_s(KeyframeId id) const {
  const Source& source = sources_.at(id);
  double behind_s = source.behind_s;
  if (behind_s == kUnknown_s)
    if (const auto robot = robots_.find(source.robot); robot != robots_.end()) behind_s = robot->second.behind_s;
  return msg::minus_s(map_.find_keyframe(id)->frame->stamp_ns, 0) + (behind_s == kUnknown_s ? 0 : behind_s);
}

void Atlas::follow(const std::string& name, const msg::MapUpdate& update, std::int64_t now_ns) {
  Robot& robot = robots_[name];
  if (robot.session_ns != update.session_ns) {
    const std::uint32_t meetings = robot.meetings;
    robot = {};
    robot.session_ns = update.session_ns;
    robot.meetings = meetings;
  }
  for (const msg::MapKeyframe& entry : update.keyframes) {
    if ((entry.content & msg::kMapRemoved) != 0) {
      withdraw(name, robot, entry.keyframe_id);
    } else if (robot.keyframes.size() < kMostAnnounced || robot.keyframes.contains(entry.keyframe_id)) {
      robot.behind_s = std::min(robot.behind_s, msg::minus_s(now_ns, entry.stamp_ns));
      follow(name, robot, entry);
    }
  }
}

void Atlas::follow(const std::string& name, Robot& robot, const msg::MapKeyframe& entry) {
  const auto [known, is_new] = robot.keyframes.try_emplace(entry.keyframe_id);
  Announced& announced = known->second;
  const Eigen::Isometry3d T_before = announced.T_robot_camera;
  announced.T_robot_camera = msg::to_isometry(entry.T_world_camera);
  announced.stamp_ns = entry.stamp_ns;
  announced.map = entry.map_id;
  if ((entry.content & msg::kMapEdges) != 0) announced.covisible = entry.covisible;
  if (is_new) {
    robot.wanted.insert(entry.keyframe_id);
    const KeyframeId here = find_known(name, entry.keyframe_id, entry.stamp_ns);
    if (here != kNoKeyframe) robot.claimed[entry.keyframe_id] = here;
  } else if (robot.here.contains(entry.keyframe_id) && has_moved(T_before, announced.T_robot_camera)) {
    crooked_[world_of(announced.keyframe)] = name;
  }
}

/// Whether a keyframe shows the same image as the one that it may be. If so, the others that were announced with it are
/// here as well; if not, each of them is looked at in its turn.
bool Atlas::settle_claim(const std::string& name, Robot& robot, KeyframeId id, const slam::Frame& frame) {
  constexpr double kAlmostAll = 0.9;
  const auto claim = robot.claimed.find(id);
  if (claim == robot.claimed.end()) return false;
  std::set<msg::Descriptor> known;
  if (const Keyframe* keyframe = map_.find_keyframe(claim->second))
    for (const msg::Feature& feature : keyframe->frame->features) known.insert(feature.descriptor);
  const auto shown = std::ranges::count_if(frame.features, [&](const auto& f) { return known.contains(f.descriptor); });
  if (static_cast<double>(shown) < kAlmostAll * static_cast<double>(frame.features.size())) {
    robot.claimed.erase(claim);
    return false;
  }
  for (const auto& [own, keyframe] : std::exchange(robot.claimed, {})) {
    const auto source = sources_.find(keyframe);
    if (source == sources_.end()) continue;
    robot.keyframes.at(own).keyframe = keyframe;
    robot.wanted.erase(own);
    robot.here.insert(own);
    if (source->second.robot == name) source->second.id = own;  // after a restart
  }
  return true;
}

/// The robot has removed it.
void Atlas::withdraw(const std::string& name, Robot& robot, KeyframeId id) {
  const auto known = robot.keyframes.find(id);
  if (known == robot.keyframes.end()) return;
  const auto source = sources_.find(known->second.keyframe);
  if (source != sources_.end() && source->second.robot == name) drop(source->first);
  robot.keyframes.erase(known);
  robot.here.erase(id);
  robot.wanted.erase(id);
  robot.claimed.erase(id);
}

const Atlas::Announced* Atlas::newest_known(const Robot& robot) {
  return robot.here.empty() ? nullptr : &robot.keyframes.at(*robot.here.rbegin());
}

/// Of what is wanted, slam still refines the newest: the rest ends here.
std::set<KeyframeId>::const_iterator Atlas::settled_end(const Robot& robot) const {
  const auto refined = static_cast<std::ptrdiff_t>(robot.keyframes.size()) - config_.settled_after;
  if (refined <= 0) return robot.wanted.begin();
  if (config_.settled_after == 0) return robot.wanted.end();
  return robot.wanted.lower_bound(std::prev(robot.keyframes.end(), config_.settled_after)->first);
}

/// Whether newer keyframes do not show the same place already.
bool Atlas::is_wanted(const Robot& robot, const Announced& announced, const Eigen::Isometry3d& T_world_robot,
                      MapId world) const {
  const auto cell = cells_.find(cell_of(world, T_world_robot * announced.T_robot_camera));
  if (cell == cells_.end()) return true;
  const double own_s = msg::minus_s(announced.stamp_ns, 0) + robot.behind_s;
  const auto newer = std::ranges::count_if(cell->second, [&](KeyframeId id) { return seen_s(id) > own_s; });
  return newer < config_.cell_keyframes;
}

msg::KeyframeRequest Atlas::missing(const std::string& name, std::size_t limit) {
  const auto found = robots_.find(name);
  if (found == robots_.end()) return {};
  Robot& robot = found->second;
  msg::KeyframeRequest request;
  request.session_ns = robot.session_ns;
  if (!robot.claimed.empty()) {
    request.keyframe_ids.push_back(robot.claimed.rbegin()->first);
    return request;
  }
  const Announced* newest = newest_known(robot);
  const Keyframe* known = newest == nullptr ? nullptr : map_.find_keyframe(newest->keyframe);
  Eigen::Isometry3d T_world_robot = Eigen::Isometry3d::Identity();
  if (known != nullptr) T_world_robot = known->T_world_camera * newest->T_robot_camera.inverse();
  for (auto id = settled_end(robot); id != robot.wanted.begin() && request.keyframe_ids.size() < limit;) {
    --id;
    if (known != nullptr && !is_wanted(robot, robot.keyframes.at(*id), T_world_robot, worlds_.at(known->map))) {
      id = robot.wanted.erase(id);
    } else {
      request.keyframe_ids.push_back(*id);
    }
  }
  return request;
}

/// The keyframe that a new one is placed by: one that sees much of the same, else the one before, else the one after.
const Atlas::Announced* Atlas::choose_parent(const Robot& robot, KeyframeId id) const {
  const Announced& own = robot.keyframes.at(id);
  const auto find = [&](KeyframeId other) -> const Announced* {
    const Announced* announced = robot.here.contains(other) ? &robot.keyframes.at(other) : nullptr;
    return announced != nullptr && announced->map == own.map ? announced : nullptr;
  };
  for (const KeyframeId neighbour : own.covisible | std::views::reverse)
    if (const Announced* other = find(neighbour)) return other;
  const auto after = robot.here.lower_bound(id);
  for (const KeyframeId before : std::ranges::subrange(robot.here.begin(), after) | std::views::reverse)
    if (const Announced* other = find(before)) return other;
  for (const KeyframeId later : std::ranges::subrange(after, robot.here.end()))
    if (const Announced* other = find(later)) return other;
  return nullptr;
}

}  // namespace rtd::atlas
