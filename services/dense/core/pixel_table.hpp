// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/geometry/camera_model.hpp"

namespace rtd::dense {

/// Where the pixels of a camera's own image lie in its undistorted one, and back; worked out once per calibration.
class PixelTable {
 public:
  void fit(const geometry::CameraModel& camera);

  int width() const { return width_; }
  int height() const { return height_; }
  /// Undistorted position (px) of a raw pixel, numbered row by row.
  const Eigen::Vector2f& undistorted(int raw_pixel) const { return undistorted_[static_cast<std::size_t>(raw_pixel)]; }
  /// Viewing ray at z = 1 of a raw pixel.
  Eigen::Vector3f ray(int raw_pixel) const {
    const Eigen::Vector2f& pixel = undistorted(raw_pixel);
    return {(pixel.x() - cx_) / fx_, (pixel.y() - cy_) / fy_, 1.0F};
  }
  /// Undistorted position (px) of p_camera (z > 0, m).
  Eigen::Vector2f project(const Eigen::Vector3f& p_camera) const {
    return {fx_ * p_camera.x() / p_camera.z() + cx_, fy_ * p_camera.y() / p_camera.z() + cy_};
  }
  /// The raw pixel that looks at an undistorted position, -1 when none does.
  int raw_pixel(const Eigen::Vector2f& undistorted) const {
    const float u = undistorted.x() + 0.5F, v = undistorted.y() + 0.5F;
    if (!(u >= 0 && v >= 0 && u < static_cast<float>(width_) && v < static_cast<float>(height_))) return -1;
    return raw_pixels_[static_cast<std::size_t>(static_cast<int>(v) * width_ + static_cast<int>(u))];
  }

 private:
  std::array<double, 11> fitted_{};
  int width_ = 0, height_ = 0;
  float fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
  std::vector<Eigen::Vector2f> undistorted_;
  std::vector<int> raw_pixels_;
};

}  // namespace rtd::dense
