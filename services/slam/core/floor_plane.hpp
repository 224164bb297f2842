// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace rtd::slam {

/// The floor as one frame shows it, in the frame of its camera.
struct FloorPlane {
  Eigen::Vector3d up_camera = Eigen::Vector3d::Zero();  ///< unit normal, away from the ground
  double height_m = 0;                                  ///< of the camera above it
  double sigma_rad = 0;                                 ///< standard deviation of the normal's direction
  int points = 0;                                       ///< that lie on it
};

/// The lowest large plane whose normal is within 40 degrees of what is expected to be up: the floor, or a table where
/// no floor is seen, which is as level. nullopt when there is none, when things lie under it or close above much of it,
/// or when its direction is worse known than by 0.6 degrees. `points_camera`: m, any order, outliers welcome.
/// `calibration_error`: share of the image by which the camera's axis may be off; rad, for nothing seen shows it.
/// Deterministic. docs/frames.md.
std::optional<FloorPlane> find_floor(const std::vector<Eigen::Vector3d>& points_camera,
                                     const Eigen::Vector3d& expected_up_camera, double calibration_error = 0);

}  // namespace rtd::slam
