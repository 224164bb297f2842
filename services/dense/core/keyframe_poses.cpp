// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/keyframe_poses.hpp"

#include <cstdlib>

#include "common/msg/transform_eigen.hpp"

namespace rtd::dense {

std::optional<KeyframePoses::Removed> KeyframePoses::hear(const msg::KeyframeEvent& event) {
  const AnchorId id = event.keyframe_id;
  if (event.kind == msg::KeyframeEventKind::kRemoved) {
    const auto found = keyframes_.find(id);
    if (found == keyframes_.end()) return std::nullopt;
    const std::int64_t stamp_ns = found->second.stamp_ns;
    keyframes_.erase(found);
    const AnchorId follows = nearest_in_time(stamp_ns);
    if (newest_ == id) newest_ = follows;
    return Removed{id, follows};
  }
  const Eigen::Isometry3d T_world_keyframe = msg::to_isometry(event.T_world_camera);
  if (!T_world_keyframe.matrix().allFinite()) return std::nullopt;
  const auto [keyframe, created] =
      keyframes_.try_emplace(id, Keyframe{event.stamp_ns, T_world_keyframe, T_world_keyframe});
  keyframe->second.T_world_keyframe = T_world_keyframe;
  if (created && (newest_ == kNoAnchor || event.stamp_ns >= keyframes_.at(newest_).stamp_ns)) newest_ = id;
  return std::nullopt;
}

const Eigen::Isometry3d* KeyframePoses::pose(AnchorId keyframe) const {
  const auto found = keyframes_.find(keyframe);
  return found == keyframes_.end() ? nullptr : &found->second.T_world_keyframe;
}

std::map<AnchorId, Eigen::Isometry3f> KeyframePoses::take_motions() {
  std::map<AnchorId, Eigen::Isometry3f> motions;
  for (auto& [id, keyframe] : keyframes_) {
    if (keyframe.T_world_keyframe.matrix() == keyframe.T_world_applied.matrix()) continue;
    motions.emplace(id, (keyframe.T_world_keyframe * keyframe.T_world_applied.inverse()).cast<float>());
    keyframe.T_world_applied = keyframe.T_world_keyframe;
  }
  return motions;
}

AnchorId KeyframePoses::nearest_in_time(std::int64_t stamp_ns) const {
  AnchorId nearest = kNoAnchor;
  std::int64_t gap_ns = 0;
  for (const auto& [id, keyframe] : keyframes_) {
    const std::int64_t other_ns = std::abs(keyframe.stamp_ns - stamp_ns);
    if (nearest != kNoAnchor && other_ns >= gap_ns) continue;
    nearest = id;
    gap_ns = other_ns;
  }
  return nearest;
}

}  // namespace rtd::dense
