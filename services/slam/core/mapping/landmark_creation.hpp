// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// Features that become landmarks from their own depth: all nearer than `close_depth_m`, and at least the 100 nearest.
/// Only those without a landmark are returned; those with one count towards the 100.
std::vector<std::uint32_t> select_close_features(const Frame& frame, const std::vector<LandmarkId>& landmarks,
                                                 double close_depth_m);

/// Makes landmarks of the keyframe's close features that have none. Returns the new ones.
std::vector<LandmarkId> create_from_depth(Map& map, KeyframeId keyframe, double close_depth_m);

/// Makes landmarks that two views agree on, from features of the keyframe and of its best covisible ones that have no
/// landmark yet: epipolar search, triangulation (or depth, where it is the better of the two), checks of
/// depth, reprojection and scale. docs/theory/mapping.md Eq. (4)-(6). Returns the new ones.
std::vector<LandmarkId> create_by_triangulation(Map& map, KeyframeId keyframe, int neighbours);

/// The point nearest to two rays in the linear least squares sense, p_world; empty when they are parallel. Normalised
/// image coordinates.
std::optional<Eigen::Vector3d> triangulate(const Eigen::Isometry3d& T_camera_world_1, const Eigen::Vector2d& n1,
                                           const Eigen::Isometry3d& T_camera_world_2, const Eigen::Vector2d& n2);

}  // namespace rtd::slam
