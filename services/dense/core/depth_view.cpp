// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/depth_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

namespace rtd::dense {

std::uint8_t DynamicMask::at(float u_px, float v_px, int width_px, int height_px) const {
  if (!(u_px >= 0 && v_px >= 0)) return kUnknown;
  const int column = static_cast<int>(u_px * static_cast<float>(columns) / static_cast<float>(width_px));
  const int row = static_cast<int>(v_px * static_cast<float>(rows) / static_cast<float>(height_px));
  if (column >= columns || row >= rows) return kUnknown;
  return cells[static_cast<std::size_t>(row * columns + column)];
}

DynamicMask grow(const DynamicMask& mask, int radius) {
  DynamicMask result = mask;
  cv::Mat cells(result.rows, result.columns, CV_8U, result.cells.data());
  const int side = 2 * radius + 1;
  cv::dilate(cells, cells, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return result;
}

DynamicMask all_static() {
  return {1, 1, {DynamicMask::kStatic}};
}

void PixelTable::fit(const geometry::CameraModel& camera) {
  const auto& p = camera.parameters();
  if (p == fitted_) return;
  fitted_ = p;
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

DepthView::DepthView(const vision::RgbdImage& image, const DynamicMask& mask, const PixelTable& table,
                     const FusionConfig& config)
    : image_(image), mask_(mask), table_(table), config_(config) {
  depth_m_.reserve(image.depth.total());
  const auto scale_m = static_cast<float>(image.depth_scale_m);
  const auto min_m = static_cast<float>(config.min_depth_m), max_m = static_cast<float>(config.max_depth_m);
  for (int row = 0; row < image.depth.rows; ++row) {
    const auto* raw = image.depth.ptr<std::uint16_t>(row);
    for (int column = 0; column < image.depth.cols; ++column) {
      const float depth_m = static_cast<float>(raw[column]) * scale_m;
      depth_m_.push_back(depth_m >= min_m && depth_m <= max_m ? depth_m : 0.0F);
    }
  }
}

bool DepthView::on_surface(int column, int row) const {
  const int width = table_.width(), pixel = row * width + column;
  if (column < 1 || row < 1 || column + 1 >= width || row + 1 >= table_.height()) return false;
  const float here_m = depth_m(pixel);
  const float step_m = static_cast<float>(config_.edge_m) + static_cast<float>(config_.edge_per_m) * here_m * here_m;
  const std::array<int, 4> neighbours{pixel - 1, pixel + 1, pixel - width, pixel + width};
  return std::all_of(neighbours.begin(), neighbours.end(), [&](int neighbour) {
    return depth_m(neighbour) > 0 && std::abs(depth_m(neighbour) - here_m) <= step_m;
  });
}

float DepthView::nearest_around_m(int raw_pixel) const {
  constexpr int kEnough = 7;
  const int width = table_.width(), column = raw_pixel % width, row = raw_pixel / width;
  if (column < 1 || row < 1 || column + 1 >= width || row + 1 >= table_.height()) return 0;
  int measured = 0;
  float nearest_m = std::numeric_limits<float>::max();
  for (int y = row - 1; y <= row + 1; ++y) {
    for (int x = column - 1; x <= column + 1; ++x) {
      const float depth = depth_m(y * width + x);
      if (depth <= 0) continue;
      ++measured;
      nearest_m = std::min(nearest_m, depth);
    }
  }
  return measured >= kEnough ? nearest_m : 0.0F;
}

std::uint8_t DepthView::motion(int raw_pixel) const {
  const Eigen::Vector2f& pixel = table_.undistorted(raw_pixel);
  return mask_.at(pixel.x(), pixel.y(), table_.width(), table_.height());
}

}  // namespace rtd::dense
