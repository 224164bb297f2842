// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/cell_masks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace rtd::filter {
namespace {

int place_of(double px) {
  return static_cast<int>(std::floor((px + 0.5) / vision::kMaskStepPx));
}

constexpr int kMinCompact = 6;  // of the 9 cells around one

/// The cells connected with `start`; they are cleared in `open`.
std::vector<int> take_region(const GridShape& shape, CellMask& open, int start) {
  std::vector<int> region{start};
  open[static_cast<std::size_t>(start)] = 0;
  const auto visit = [&](int cell) {
    if (open[static_cast<std::size_t>(cell)] == 0) return;
    open[static_cast<std::size_t>(cell)] = 0;
    region.push_back(cell);
  };
  for (std::size_t i = 0; i < region.size(); ++i) {
    const int cell = region[i], column = cell % shape.columns;
    if (column > 0) visit(cell - 1);
    if (column + 1 < shape.columns) visit(cell + 1);
    if (cell >= shape.columns) visit(cell - shape.columns);
    if (cell + shape.columns < shape.size()) visit(cell + shape.columns);
  }
  return region;
}

}  // namespace

BoxMask::BoxMask(const vision::PersonMasks& masks, std::uint8_t label, const vision::Detection& box) : box_(box) {
  const bool complete =
      masks.columns > 0 && masks.rows > 0 &&
      masks.labels.size() == static_cast<std::size_t>(masks.columns) * static_cast<std::size_t>(masks.rows);
  if (!complete || label == 0) return;
  int right = 0, bottom = 0;
  left_ = masks.columns;
  top_ = masks.rows;
  for (int row = 0; row < masks.rows; ++row) {
    for (int column = 0; column < masks.columns; ++column) {
      if (masks.at(column, row) != label) continue;
      left_ = std::min(left_, column);
      top_ = std::min(top_, row);
      right = std::max(right, column + 1);
      bottom = std::max(bottom, row + 1);
    }
  }
  if (right <= left_) return;
  columns_ = right - left_;
  rows_ = bottom - top_;
  places_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = top_; row < bottom; ++row) {
    for (int column = left_; column < right; ++column) places_.push_back(masks.at(column, row) == label ? 1 : 0);
  }
}

bool BoxMask::covers(const Eigen::Vector2d& raw_px, const vision::Detection& now) const {
  if (places_.empty()) return false;
  const auto then = [](double px, double now_px, double now_size, double then_px, double then_size) {
    return (px - now_px) / now_size * then_size + then_px;
  };
  const int column = place_of(then(raw_px.x(), now.x_px, now.width_px, box_.x_px, box_.width_px)) - left_;
  const int row = place_of(then(raw_px.y(), now.y_px, now.height_px, box_.y_px, box_.height_px)) - top_;
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return false;
  return places_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(column)] != 0;
}

template <typename T>
std::vector<T> largest_near(const GridShape& shape, std::vector<T> values, int radius) {
  cv::Mat image(shape.rows, shape.columns, cv::DataType<T>::type, values.data());
  cv::dilate(image, image, cv::Mat::ones(2 * radius + 1, 2 * radius + 1, CV_8U));
  return values;
}
template std::vector<std::uint8_t> largest_near(const GridShape&, std::vector<std::uint8_t>, int);
template std::vector<std::int16_t> largest_near(const GridShape&, std::vector<std::int16_t>, int);
template std::vector<float> largest_near(const GridShape&, std::vector<float>, int);

std::vector<float> smallest_near(const GridShape& shape, std::vector<float> values, int radius) {
  cv::Mat image(shape.rows, shape.columns, CV_32F, values.data());
  cv::erode(image, image, cv::Mat::ones(2 * radius + 1, 2 * radius + 1, CV_8U));
  return values;
}

CellMask dilate(const GridShape& shape, CellMask cells, int radius) {
  return largest_near(shape, std::move(cells), radius);
}

CellMask united(CellMask a, const CellMask& b) {
  std::transform(a.begin(), a.end(), b.begin(), a.begin(), [](auto x, auto y) { return std::max(x, y); });
  return a;
}

CellMask compact(const GridShape& shape, const CellMask& cells) {
  CellMask result(cells.size(), 0);
  for (int row = 1; row + 1 < shape.rows; ++row) {
    for (int column = 1; column + 1 < shape.columns; ++column) {
      const auto centre = static_cast<std::size_t>(shape.index(column, row));
      if (cells[centre] == 0) continue;
      int set = 0;
      for (int y = row - 1; y <= row + 1; ++y) {
        for (int x = column - 1; x <= column + 1; ++x) {
          set += cells[static_cast<std::size_t>(shape.index(x, y))] > 0 ? 1 : 0;
        }
      }
      if (set >= kMinCompact) result[centre] = cells[centre];
    }
  }
  return result;
}

CellMask keep_regions(const GridShape& shape, CellMask cells,
                      const std::function<bool(const std::vector<int>&)>& keep) {
  CellMask open(cells);
  for (int start = 0; start < shape.size(); ++start) {
    if (open[static_cast<std::size_t>(start)] == 0) continue;
    const std::vector<int> region = take_region(shape, open, start);
    if (keep(region)) continue;
    for (const int cell : region) cells[static_cast<std::size_t>(cell)] = 0;
  }
  return cells;
}

}  // namespace rtd::filter
