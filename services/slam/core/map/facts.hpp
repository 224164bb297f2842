// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// What a map knows of one of its landmarks. World frame, m.
struct LandmarkFacts {
  LandmarkId id = kNoLandmark;
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  std::optional<Eigen::Matrix3d> covariance;  ///< against the keyframes that see it; empty: they do not determine it
  double static_probability = 1;
  std::uint32_t visible = 0, found = 0;  ///< frames that should have seen it / did
  std::vector<std::int64_t> seen_ns;     ///< stamps of the keyframes that see it, in the order of their ids
};

/// The landmark of a keyframe that is nearest to a place in its camera's frame; empty when none is near it.
std::optional<LandmarkFacts> facts_of_landmark(const Map& map, KeyframeId keyframe, const Eigen::Vector3d& p_camera);

}  // namespace rtd::slam
