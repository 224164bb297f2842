// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/transform_log.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/msg/stamps.hpp"

namespace rtd::geometry {
namespace {

constexpr const char* kWorld = "world";
constexpr std::size_t kMostLinks = 100;  // from one frame to another; a ring has no end

}  // namespace

std::string bare_frame(const std::string& frame) {
  return frame.substr(frame.starts_with('/') ? 1 : 0);
}

std::optional<Eigen::Isometry3d> to_isometry(const msg::RosTransform& transform) {
  const auto& [t, q] = transform;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  const Eigen::Vector3d translation(t.x, t.y, t.z);
  if (!translation.allFinite() || !(std::abs(rotation.norm() - 1.0) < 0.05)) return std::nullopt;
  Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
  T_parent_child.linear() = rotation.normalized().toRotationMatrix();
  T_parent_child.translation() = translation;
  return T_parent_child;
}

void TransformLog::add(const msg::TFMessage& message) {
  for (const msg::TransformStamped& transform : message.transforms) {
    const std::optional<Eigen::Isometry3d> T_parent_child = to_isometry(transform.transform);
    if (!T_parent_child) continue;
    Link& link = links_[bare_frame(transform.child_frame_id)];
    link.parent = bare_frame(transform.header.frame_id);
    link.T_parent_child.insert_or_assign(msg::to_ns(transform.header.stamp), *T_parent_child);
  }
}

Eigen::Isometry3d TransformLog::Link::at(std::int64_t stamp_ns) const {
  const auto after = T_parent_child.lower_bound(stamp_ns);
  if (after == T_parent_child.begin()) return after->second;
  const auto before = std::prev(after);
  const bool later =
      after != T_parent_child.end() && msg::minus_ns(after->first, stamp_ns) < msg::minus_ns(stamp_ns, before->first);
  return later ? after->second : before->second;
}

/// From the camera up to the transform that begins at `world`; empty when there is none.
std::vector<const TransformLog::Link*> TransformLog::chain_to_world(const std::string& camera_frame) const {
  std::vector<const Link*> chain;
  for (auto link = links_.find(bare_frame(camera_frame)); link != links_.end();
       link = links_.find(link->second.parent)) {
    chain.push_back(&link->second);
    if (link->second.parent == kWorld || chain.size() == kMostLinks) break;
  }
  if (chain.empty() || chain.back()->parent != kWorld) return {};
  return chain;
}

/// The transforms below the last one of the chain.
Eigen::Isometry3d TransformLog::T_child_camera(const std::vector<const Link*>& chain, std::int64_t stamp_ns) {
  Eigen::Isometry3d T_child_camera = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) T_child_camera = chain[i]->at(stamp_ns) * T_child_camera;
  return T_child_camera;
}

Trajectory TransformLog::world_poses(const std::string& camera_frame) const {
  const std::vector<const Link*> chain = chain_to_world(camera_frame);
  Trajectory poses;
  if (chain.empty()) return poses;
  for (const auto& [stamp_ns, T_world_child] : chain.back()->T_parent_child)
    poses.push_back({stamp_ns, T_world_child * T_child_camera(chain, stamp_ns)});
  return poses;
}

std::optional<Eigen::Isometry3d> TransformLog::world_pose(const std::string& camera_frame, std::int64_t stamp_ns,
                                                          std::int64_t max_gap_ns) const {
  const std::vector<const Link*> chain = chain_to_world(camera_frame);
  if (chain.empty()) return std::nullopt;
  const auto& measured = chain.back()->T_parent_child;
  const auto after = measured.lower_bound(stamp_ns);
  Trajectory around;
  if (after != measured.begin()) around.push_back({std::prev(after)->first, std::prev(after)->second});
  if (after != measured.end()) around.push_back({after->first, after->second});
  const auto T_world_child = pose_at(around, stamp_ns, max_gap_ns);
  if (!T_world_child) return std::nullopt;
  return *T_world_child * T_child_camera(chain, stamp_ns);
}

std::vector<TransformLog::Above> TransformLog::chain_from(const std::string& frame) const {
  std::vector<Above> chain{{bare_frame(frame), Eigen::Isometry3d::Identity()}};
  while (chain.size() <= kMostLinks) {
    const auto link = links_.find(chain.back().frame);
    if (link == links_.end()) break;
    const Eigen::Isometry3d& T_parent_child = link->second.T_parent_child.rbegin()->second;
    chain.push_back({link->second.parent, T_parent_child * chain.back().T_frame_start});
  }
  return chain;
}

std::optional<Eigen::Isometry3d> TransformLog::between(const std::string& target, const std::string& source) const {
  const std::vector<Above> above_target = chain_from(target);
  for (const Above& of_source : chain_from(source)) {
    for (const Above& of_target : above_target) {
      if (of_target.frame == of_source.frame) return of_target.T_frame_start.inverse() * of_source.T_frame_start;
    }
  }
  return std::nullopt;
}

std::pair<std::string, Eigen::Isometry3d> TransformLog::root_of(const std::string& frame) const {
  const Above root = chain_from(frame).back();
  return {root.frame, root.T_frame_start};
}

bool TransformLog::knows(const std::string& frame) const {
  const std::string bare = bare_frame(frame);
  return links_.contains(bare) ||
         std::ranges::any_of(links_, [&](const auto& link) { return link.second.parent == bare; });
}

std::set<std::string> TransformLog::frames() const {
  std::set<std::string> names;
  for (const auto& [child, link] : links_) names.insert({child, link.parent});
  return names;
}

}  // namespace rtd::geometry
