// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/geometry/se3.hpp"
#include "services/slam/core/map/local_map.hpp"

namespace rtd::slam {

/// How uncertain the map itself is where the camera is, docs/theory/tracking.md Eq. (13), (14): a landmark is as
/// uncertain as the keyframe that found it first, a keyframe as uncertain as what it was tracked by and its own pose
/// against it. Covariances are of (x y z rx ry rz) in the world frame.
class MapUncertainty {
 public:
  /// Covariance in the world of a pose that was measured against these landmarks (per feature) with `local`.
  geometry::Matrix6d in_world(const geometry::Matrix6d& local, const Eigen::Vector3d& position,
                              const std::vector<LandmarkId>& landmarks, const LocalMap& map);
  /// The frame becomes a keyframe; `covariance` is that of in_world().
  void add_keyframe(std::uint64_t frame_seq, const Eigen::Vector3d& position, const geometry::Matrix6d& covariance);

 private:
  struct Known {
    Eigen::Vector3d position;
    geometry::Matrix6d covariance;
  };
  std::optional<geometry::Matrix6d> of_landmarks(const Eigen::Vector3d& position,
                                                 const std::vector<LandmarkId>& landmarks, const LocalMap& map) const;

  std::unordered_map<std::uint64_t, Known> keyframes_;  ///< by the seq of their frame
};

}  // namespace rtd::slam
