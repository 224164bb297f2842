// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>

#include "common/msg/tracking.hpp"
#include "services/dense/core/voxel_map.hpp"

namespace rtd::dense {

/// Where slam's keyframes are now, and how far they have moved since the map last followed them.
class KeyframePoses {
 public:
  /// A keyframe that goes away: its points follow another one from now on.
  struct Removed {
    AnchorId keyframe = kNoAnchor, follows = kNoAnchor;
  };
  /// Takes one word of slam. Poses that are not finite are ignored.
  std::optional<Removed> hear(const msg::KeyframeEvent& event);
  /// The keyframe that new points hang on: the newest; kNoAnchor before the first.
  AnchorId newest() const { return newest_; }
  /// T_world_keyframe as last heard; nullptr for an unknown one.
  const Eigen::Isometry3d* pose(AnchorId keyframe) const;
  /// What the corrections since the last call do to points in the world, by keyframe: T_new * T_old^-1.
  std::map<AnchorId, Eigen::Isometry3f> take_motions();
  void clear() { *this = {}; }

 private:
  struct Keyframe {
    std::int64_t stamp_ns = 0;
    Eigen::Isometry3d T_world_keyframe, T_world_applied;  ///< as heard; as the map's points have it
  };
  AnchorId nearest_in_time(std::int64_t stamp_ns) const;

  std::map<AnchorId, Keyframe> keyframes_;
  AnchorId newest_ = kNoAnchor;
};

}  // namespace rtd::dense
