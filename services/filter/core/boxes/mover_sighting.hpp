// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_clusters.hpp"
#include "services/filter/core/boxes/kalman.hpp"

namespace rtd::filter {

/// The frame as the tracks of movers see it.
struct MoverFrame {
  const DepthGrid& grid;
  const std::vector<Eigen::Vector3f>& rays;
  const geometry::CameraModel& camera;
  CameraPose pose;
};

/// A surface that was seen moving: what one frame shows of a mover.
struct MoverSighting {
  Eigen::AlignedBox3d extent_world;  ///< 5 % of its cells lie beyond each side
  Box box_px;                        ///< image of the extent, undistorted pixels
  bool cut_off = false;              ///< by the border of the image
};

/// The clusters with at least 40 of these cells, in the order of their labels. `moving`: per cell, 1 = seen moving.
std::vector<MoverSighting> sight_movers(const MoverFrame& frame, const DepthClusters& clusters, const CellMask& moving);

/// Image of a box in space, undistorted pixels; nullopt if a corner is behind the camera.
std::optional<Box> project(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame);
/// What is seen at the place of a box in space.
struct BoxContent {
  std::vector<int> cells;  ///< whose points lie in the box, ascending
  int measured = 0;        ///< cells with a depth in front of it, in it and behind it
};
BoxContent look_into(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame);

}  // namespace rtd::filter
