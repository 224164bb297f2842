// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/depth_grid.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "services/filter/core/surfaces/cell_masks.hpp"

namespace rtd::filter {
namespace {

constexpr float kUnmeasuredNear = std::numeric_limits<float>::max();

/// Per cell: are enough of its 3x3 neighbourhood measured?
std::vector<std::uint8_t> well_surrounded(const DepthGrid& grid) {
  std::vector<std::uint8_t> count(grid.depth_m.size());
  std::transform(grid.depth_m.begin(), grid.depth_m.end(), count.begin(),
                 [](float depth_m) { return static_cast<std::uint8_t>(depth_m > 0 ? 1 : 0); });
  cv::Mat image(grid.shape.rows, grid.shape.columns, CV_8U, count.data());
  cv::boxFilter(image, image, CV_8U, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  for (std::uint8_t& cell : count) cell = cell >= DepthGrid::kMinNeighbours ? 1 : 0;
  return count;
}

/// Spreads the range of each cell over its 3x3 neighbourhood.
void widen_ranges(DepthGrid& grid) {
  const std::vector<std::uint8_t> enough = well_surrounded(grid);
  grid.near_m = smallest_near(grid.shape, std::move(grid.near_m), 1);
  grid.far_m = largest_near(grid.shape, std::move(grid.far_m), 1);
  for (std::size_t i = 0; i < enough.size(); ++i) {
    if (enough[i] == 0) grid.near_m[i] = grid.far_m[i] = 0;
  }
}

}  // namespace

void DepthGridSampler::fit(const vision::RgbdImage& image) {
  if (size_ == image.depth.size() && parameters_ == image.camera.parameters()) return;
  size_ = image.depth.size();
  parameters_ = image.camera.parameters();
  const int side_px = cell_side_px(size_.width, size_.height);
  shape_ = {std::max(1, size_.width / side_px), std::max(1, size_.height / side_px), side_px};
  pixels_.clear();
  rays_.clear();
  const std::array<double, 2> offsets{0.25 * side_px - 0.5, 0.75 * side_px - 0.5};  // two by two samples, evenly spread
  for (int row = 0; row < shape_.rows; ++row) {
    for (int column = 0; column < shape_.columns; ++column) {
      const Eigen::Vector2d corner(column * side_px, row * side_px);
      for (int k = 0; k < kSamples; ++k) {
        const Eigen::Vector2d raw = image.camera.distort(corner + Eigen::Vector2d(offsets[k % 2], offsets[k / 2]));
        const long u = std::lround(raw.x()), v = std::lround(raw.y());
        const bool inside = u >= 0 && v >= 0 && u < size_.width && v < size_.height;
        pixels_.push_back(inside ? static_cast<int>(v * size_.width + u) : -1);
      }
      const Eigen::Vector2d centre = corner.array() + 0.5 * (side_px - 1);
      rays_.push_back(image.camera.unproject(centre, 1.0).cast<float>());
    }
  }
}

DepthGrid DepthGridSampler::sample(const vision::RgbdImage& image) {
  fit(image);
  const auto cells = static_cast<std::size_t>(shape_.size());
  DepthGrid grid{shape_, std::vector<float>(cells), std::vector<float>(cells, kUnmeasuredNear),
                 std::vector<float>(cells)};
  const auto scale_m = static_cast<float>(image.depth_scale_m);
  const auto min_m = static_cast<float>(min_depth_m_), max_m = static_cast<float>(max_depth_m_);
  const cv::Mat depth = image.depth.isContinuous() ? image.depth : image.depth.clone();
  const auto* raw = depth.ptr<std::uint16_t>();
  for (std::size_t cell = 0; cell < cells; ++cell) {
    std::array<float, kSamples> values{};  // ascending
    std::size_t count = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      const int pixel = pixels_[cell * kSamples + k];
      const float value_m = pixel < 0 ? 0.0F : static_cast<float>(raw[pixel]) * scale_m;
      if (value_m < min_m || value_m > max_m) continue;
      std::size_t place = count++;
      for (; place > 0 && values[place - 1] > value_m; --place) values[place] = values[place - 1];
      values[place] = value_m;
    }
    if (2 * count < kSamples) continue;  // half of the samples must be measured
    grid.depth_m[cell] = values[(count - 1) / 2];
    grid.near_m[cell] = values[0];
    grid.far_m[cell] = values[count - 1];
  }
  widen_ranges(grid);
  return grid;
}

cv::Vec3b DepthGridSampler::color_bgr(const vision::RgbdImage& image, std::size_t cell) const {
  cv::Vec3i sum(0, 0, 0);
  int count = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const int pixel = pixels_[cell * kSamples + k];
    if (pixel < 0) continue;
    sum += cv::Vec3i(image.color_bgr.at<cv::Vec3b>(pixel / size_.width, pixel % size_.width));
    ++count;
  }
  return count > 0 ? cv::Vec3b(sum / count) : cv::Vec3b(0, 0, 0);
}

}  // namespace rtd::filter
