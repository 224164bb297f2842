// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
inline constexpr int kCellPx = cell_side_px(640, 480);  ///< side of a cell of the scenes' camera
}

namespace rtd::filter::test {

/// Cells of a 640x480 image, and a block in it on whole cells.
inline const GridShape kShape{160, 120};
inline const cv::Rect kBlock(240, 160, 120, 160);

/// A wall at `wall_m` that fills the image, without texture.
inline vision::RgbdImage wall_image(double wall_m = 3.0) {
  return rgbd_image(cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)), wall_m);
}
/// Something flat and upright in front of it.
inline void put_block(vision::RgbdImage& image, const cv::Rect& area, double depth_m) {
  image.depth(area & cv::Rect(0, 0, image.depth.cols, image.depth.rows))
      .setTo(cv::Scalar(depth_m / image.depth_scale_m));
}

inline DepthGridSampler make_sampler() {
  return {0.3, 10.0};
}

/// An image with its surfaces, as a mode judges it.
class TestScene {
 public:
  explicit TestScene(const vision::RgbdImage& image)
      : image_(image),
        sampler_(make_sampler()),
        grid_(sampler_.sample(image)),
        surfaces_{grid_, find_depth_clusters(grid_, {}), sampler_.rays()} {}
  /// `objects` must outlive the result.
  Scene with(const std::vector<SceneObject>& objects) const { return {image_, surfaces_, objects, true}; }

 private:
  vision::RgbdImage image_;
  DepthGridSampler sampler_;
  DepthGrid grid_;
  Surfaces surfaces_;
};

/// Set cells of a mask in a pixel rectangle.
inline int count_in(const GridShape& shape, const std::vector<std::uint8_t>& cells, const cv::Rect& area_px) {
  int count = 0;
  for (int y = area_px.y / kCellPx; y < (area_px.y + area_px.height) / kCellPx; ++y) {
    for (int x = area_px.x / kCellPx; x < (area_px.x + area_px.width) / kCellPx; ++x) {
      count += cells[static_cast<std::size_t>(shape.index(x, y))] != 0 ? 1 : 0;
    }
  }
  return count;
}
inline int cells_in(const cv::Rect& area_px) {
  return area_px.area() / (kCellPx * kCellPx);
}

}  // namespace rtd::filter::test
