// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/pixel_table.hpp"

#include <cmath>

namespace rtd::dense {

void PixelTable::fit(const geometry::CameraModel& camera) {
  const auto& p = camera.parameters();
  const auto& [k1, k2, p1, p2, k3] = p.distortion;
  const std::array<double, 11> wanted{
      p.fx, p.fy, p.cx, p.cy, k1, k2, p1, p2, k3, static_cast<double>(p.width), static_cast<double>(p.height)};
  if (wanted == fitted_) return;
  fitted_ = wanted;
  width_ = p.width;
  height_ = p.height;
  fx_ = static_cast<float>(p.fx);
  fy_ = static_cast<float>(p.fy);
  cx_ = static_cast<float>(p.cx);
  cy_ = static_cast<float>(p.cy);
  undistorted_.clear();
  raw_pixels_.clear();
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      undistorted_.emplace_back(camera.undistort({u, v}).cast<float>());
      const Eigen::Vector2d raw = camera.distort({u, v});
      const long column = std::lround(raw.x()), row = std::lround(raw.y());
      const bool inside = column >= 0 && row >= 0 && column < width_ && row < height_;
      raw_pixels_.push_back(inside ? static_cast<int>(row * width_ + column) : -1);
    }
  }
}

}  // namespace rtd::dense
