// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "services/slam/core/map/map.hpp"
#include "services/slam/core/slam_config.hpp"

namespace rtd::slam {

/// A keyframe found at a place that it has no landmarks in common with.
struct PlaceMeeting {
  KeyframeId place = kNoKeyframe;  ///< keyframe there that sees most of what was found
  Eigen::Isometry3d T_world_camera =
      Eigen::Isometry3d::Identity();  ///< of the keyframe, in the world of the place's landmarks
  std::vector<LandmarkId> landmarks;  ///< per feature of the keyframe: landmark of the place, kNoLandmark where none
  int inliers = 0;
  double found_share = 0;  ///< of the place's landmarks that should be visible from there
};

/// Looks for a place in a keyframe: descriptors, 3D-3D RANSAC, robust optimisation, then every landmark of the place
/// that should be visible is searched and the pose optimised with all of them, twice. Empty when that ends with
/// fewer than `min_inliers` landmarks or `min_found_share`. docs/theory/loop_closing.md, "Verification".
std::optional<PlaceMeeting> meet_place(const Map& map, KeyframeId keyframe, KeyframeId candidate,
                                       const SlamConfig& config);

/// Joins the landmarks of a keyframe and its neighbours with those of the place it was found at; both stand where they
/// belong already. First those that the meeting found, then by projection. Returns how many landmarks were joined or
/// gained an observation. docs/theory/loop_closing.md, "Fusion".
int fuse_place(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting, int neighbours);

}  // namespace rtd::slam
