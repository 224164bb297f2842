// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/depth_noise.hpp"

namespace rtd::filter {

/// The same point measured in the current camera frame and known in the world.
struct PointPair {
  Eigen::Vector3d p_camera;  ///< m
  Eigen::Vector3d p_world;   ///< m
};

/// T_world_camera that brings most pairs together (triples, closed form of Umeyama 1991 without scale), whatever the start.
/// A pair agrees when its distance is below 2 cm + 3 sigma(z). Deterministic; empty with fewer than three pairs.
std::optional<Eigen::Isometry3d> rigid_ransac(const std::vector<PointPair>& pairs, int iterations, const geometry::DepthNoise& noise);

}  // namespace rtd::filter
