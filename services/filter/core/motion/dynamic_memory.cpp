// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/dynamic_memory.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::filter {

void DynamicMemory::store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                          const std::vector<std::uint8_t>& frames_left) {
  points_.clear();
  for (std::size_t cell = 0; cell < frames_left.size(); ++cell) {
    if (frames_left[cell] > 0 && grid.depth_m[cell] > 0)
      points_.push_back({rays[cell] * grid.depth_m[cell], frames_left[cell]});
  }
}

std::vector<std::uint8_t> DynamicMemory::recall(const DepthGrid& grid, const geometry::CameraModel& camera,
                                                const Eigen::Isometry3d& T_current_last) const {
  constexpr float kOwnDepthM = 0.2F;  // a mover of 3 m/s gets 0.1 m nearer from frame to frame
  constexpr float kMinDepthM = 0.1F;
  const Eigen::Matrix3f rotation = T_current_last.linear().cast<float>();
  const Eigen::Vector3f translation = T_current_last.translation().cast<float>();
  const auto& p = camera.parameters();
  const auto fx = static_cast<float>(p.fx), fy = static_cast<float>(p.fy);
  const auto cx = static_cast<float>(p.cx), cy = static_cast<float>(p.cy);
  std::vector<std::uint8_t> frames_left(static_cast<std::size_t>(grid.shape.size()), 0);
  for (const Point& point : points_) {
    const Eigen::Vector3f p_current = rotation * point.p_camera + translation;
    if (p_current.z() < kMinDepthM) continue;
    // Two by two cells: no holes when things come nearer.
    const auto left = static_cast<int>(std::floor((fx * p_current.x() / p_current.z() + cx) / kCellPx - 0.5F));
    const auto top = static_cast<int>(std::floor((fy * p_current.y() / p_current.z() + cy) / kCellPx - 0.5F));
    for (int row = std::max(top, 0); row <= std::min(top + 1, grid.shape.rows - 1); ++row) {
      for (int column = std::max(left, 0); column <= std::min(left + 1, grid.shape.columns - 1); ++column) {
        const auto i = static_cast<std::size_t>(grid.shape.index(column, row));
        if (std::abs(grid.depth_m[i] - p_current.z()) < kOwnDepthM)
          frames_left[i] = std::max(frames_left[i], point.frames_left);
      }
    }
  }
  return frames_left;
}

}  // namespace rtd::filter
