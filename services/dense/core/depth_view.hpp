// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/vision/rgbd_image.hpp"
#include "services/dense/core/dense_config.hpp"
#include "services/dense/core/dynamic_mask.hpp"
#include "services/dense/core/pixel_table.hpp"

namespace rtd::dense {

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
  /// Smallest depth of the 3x3 pixels around, m; 0 when too few of them were measured to tell.
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
