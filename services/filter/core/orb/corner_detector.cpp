// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/corner_detector.hpp"

#include <algorithm>
#include <opencv2/features2d.hpp>

namespace rtd::filter {
namespace {

constexpr int kFastRadiusPx =
    3;  // the circle of FAST-9-16: cv::FAST reports nothing nearer to the edge of what it is given

/// Appends the corners inside `area` (which keeps kFastRadiusPx from the image border).
void append_fast(const cv::Mat& grey, const cv::Rect& area, int threshold, std::vector<Corner>& corners) {
  const cv::Rect with_circle(area.x - kFastRadiusPx, area.y - kFastRadiusPx, area.width + 2 * kFastRadiusPx,
                             area.height + 2 * kFastRadiusPx);
  std::vector<cv::KeyPoint> found;
  cv::FAST(grey(with_circle), found, threshold, true);
  for (const cv::KeyPoint& point : found) {
    corners.push_back({point.pt.x + static_cast<float>(with_circle.x), point.pt.y + static_cast<float>(with_circle.y),
                       point.response});
  }
}

/// Cells of equal size that cover an area.
struct CellGrid {
  cv::Rect area;
  int columns, rows;
  CellGrid(const cv::Rect& covered, int cell_px)
      : area(covered), columns(std::max(1, covered.width / cell_px)), rows(std::max(1, covered.height / cell_px)) {}
  int left(int column) const { return area.x + column * area.width / columns; }
  int top(int row) const { return area.y + row * area.height / rows; }
  std::size_t index(const Corner& corner) const {
    const int column = std::min(columns - 1, (static_cast<int>(corner.x) - area.x) * columns / area.width);
    const int row = std::min(rows - 1, (static_cast<int>(corner.y) - area.y) * rows / area.height);
    return static_cast<std::size_t>(row * columns + column);
  }
};

}  // namespace

std::vector<Corner> detect_corners(const cv::Mat& grey, const OrbConfig& config) {
  std::vector<Corner> corners;
  const cv::Rect usable(kBorderPx, kBorderPx, grey.cols - 2 * kBorderPx, grey.rows - 2 * kBorderPx);
  if (usable.width <= 0 || usable.height <= 0) return corners;

  append_fast(grey, usable, config.fast_threshold, corners);
  const CellGrid grid(usable, config.cell_px);
  std::vector<char> occupied(static_cast<std::size_t>(grid.columns * grid.rows), 0);
  for (const Corner& corner : corners) occupied[grid.index(corner)] = 1;

  for (int row = 0; row < grid.rows; ++row) {
    const char* cells = &occupied[static_cast<std::size_t>(row * grid.columns)];
    for (int begin = 0; begin < grid.columns; ++begin) {
      if (cells[begin] != 0) continue;
      int end = begin;  // a run of empty cells is searched in one call
      while (end < grid.columns && cells[end] == 0) ++end;
      const cv::Rect run(grid.left(begin), grid.top(row), grid.left(end) - grid.left(begin),
                         grid.top(row + 1) - grid.top(row));
      append_fast(grey, run, config.fast_threshold_low, corners);
      begin = end;
    }
  }
  return corners;
}

}  // namespace rtd::filter
