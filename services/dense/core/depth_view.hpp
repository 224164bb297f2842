// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/dense/core/dense_config.hpp"

namespace rtd::dense {

/// What the filter found out about the cells of one frame, in undistorted pixels.
struct DynamicMask {
  enum : std::uint8_t { kStatic = 0, kUnknown = 128, kDynamic = 255 };
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> cells;  ///< row by row; more than kUnknown = dynamic

  /// Value at an undistorted pixel of an image of this size; kUnknown outside the mask.
  std::uint8_t at(float u_px, float v_px, int width_px, int height_px) const;
};

/// The same with everything within `radius` cells (square) of a larger value raised to it.
DynamicMask grow(const DynamicMask& mask, int radius);

/// A mask of one cell that calls everything static.
DynamicMask all_static();

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
  geometry::CameraModel::Parameters fitted_;
  int width_ = 0, height_ = 0;
  float fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
  std::vector<Eigen::Vector2f> undistorted_;
  std::vector<int> raw_pixels_;
};

/// One frame as the map sees it: depth in metres by raw pixel, with what is known of its motion.
class DepthView {
 public:
  /// `image`, `mask` and `table` (fitted to the image's camera) must outlive it.
  DepthView(const vision::RgbdImage& image, const DynamicMask& mask, const PixelTable& table,
            const FusionConfig& config);

  /// Depth of a raw pixel, m; 0 = not measured or out of range.
  float depth_m(int raw_pixel) const { return depth_m_[static_cast<std::size_t>(raw_pixel)]; }
  /// A reading of one surface, not a mix of a near and a far one: it has no large step to a neighbour.
  bool on_surface(int column, int row) const;
  /// Smallest depth of the 3x3 pixels around, m; 0 when too few of them were measured.
  float nearest_around_m(int raw_pixel) const;
  std::uint8_t motion(int raw_pixel) const;

  const vision::RgbdImage& image() const { return image_; }
  const PixelTable& table() const { return table_; }

 private:
  const vision::RgbdImage& image_;
  const DynamicMask& mask_;
  const PixelTable& table_;
  const FusionConfig& config_;
  std::vector<float> depth_m_;
};

}  // namespace rtd::dense
