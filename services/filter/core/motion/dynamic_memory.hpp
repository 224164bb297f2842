// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// Where things moved in the last frame, so that a mover that slows down or pauses is not believed at once.
class DynamicMemory {
 public:
  /// `frames_left` per cell of the frame just judged; its points are kept in the camera frame.
  void store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
             const std::vector<std::uint8_t>& frames_left);
  /// The same as seen by the current frame: points are moved by the camera's motion and must find about their own depth
  /// there.
  std::vector<std::uint8_t> recall(const DepthGrid& grid, const geometry::CameraModel& camera,
                                   const Eigen::Isometry3d& T_current_last) const;
  void clear() { points_.clear(); }

 private:
  struct Point {
    Eigen::Vector3f p_camera;
    std::uint8_t frames_left;
  };
  std::vector<Point> points_;
};

}  // namespace rtd::filter
