// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/corners.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <queue>

#include "services/filter/core/orb/fast_scores.hpp"

namespace rtd::filter {
namespace {

/// The first pixel of the row from x on that has a score, eight at a time; right + 1 if there is none.
int next_score(const std::uint8_t* row, int x, int right) {
  std::uint64_t eight = 0;
  for (; x + 7 <= right; x += 8) {
    std::memcpy(&eight, row + x, sizeof eight);
    if (eight != 0) break;
  }
  while (x <= right && row[x] == 0) ++x;
  return x;
}

/// Scores of a level, and those of them that are peaks among all.
struct Scored {
  cv::Mat scores, peaks;
};

/// Whether no neighbour in `area` has as much.
bool is_peak(const cv::Mat& scores, const cv::Rect& area, int x, int y) {
  const std::uint8_t score = scores.at<std::uint8_t>(y, x);
  const int right = area.x + area.width - 1, bottom = area.y + area.height - 1;
  for (int row = std::max(area.y, y - 1); row <= std::min(bottom, y + 1); ++row) {
    const std::uint8_t* neighbours = scores.ptr(row);
    for (int column = std::max(area.x, x - 1); column <= std::min(right, x + 1); ++column)
      if (neighbours[column] >= score && (row != y || column != x)) return false;
  }
  return true;
}

/// Appends the corners inside `area`: scores above the threshold and above those of all neighbours in `area`. Only at
/// its edge are these others than the peaks among all.
void append_corners(const Scored& level, const cv::Rect& area, int threshold, std::vector<Corner>& corners) {
  const int right = area.x + area.width - 1, bottom = area.y + area.height - 1;
  const auto append = [&](int x, int y, std::uint8_t score) {
    if (score > threshold)
      corners.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(score - 1)});
  };
  const auto append_of_edge = [&](int y, int first, int last) {
    const std::uint8_t* scores = level.scores.ptr(y);
    for (int x = next_score(scores, first, last); x <= last; x = next_score(scores, x + 1, last))
      if (is_peak(level.scores, area, x, y)) append(x, y, scores[x]);
  };
  for (int y = area.y; y <= bottom; ++y) {
    if (y == area.y || y == bottom) {
      append_of_edge(y, area.x, right);
      continue;
    }
    append_of_edge(y, area.x, area.x);
    const std::uint8_t* peaks = level.peaks.ptr(y);
    for (int x = next_score(peaks, area.x + 1, right - 1); x < right; x = next_score(peaks, x + 1, right - 1))
      append(x, y, peaks[x]);
    if (right > area.x) append_of_edge(y, right, right);
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

/// A cell of the tree: a rectangle and the corners in it, a range of one shared array.
struct Cell {
  float left, top, right, bottom;
  std::size_t begin, end;
  int depth;
  std::size_t size() const { return end - begin; }
};

/// The next to be split comes out first: coarse before fine, then full before sparse, then by position in the array.
struct SplitsLater {
  bool operator()(const Cell& a, const Cell& b) const {
    if (a.depth != b.depth) return a.depth > b.depth;
    if (a.size() != b.size()) return a.size() < b.size();
    return a.begin > b.begin;
  }
};

/// Reorders the corners of a cell by quadrant and returns the quadrants that have any.
std::vector<Cell> split(const Cell& cell, std::vector<Corner>& corners) {
  const float middle_x = 0.5F * (cell.left + cell.right), middle_y = 0.5F * (cell.top + cell.bottom);
  const auto at = [&](std::size_t i) { return corners.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto position = [&](auto it) { return static_cast<std::size_t>(it - corners.begin()); };
  const auto is_upper = [&](const Corner& c) { return c.y < middle_y; };
  const auto is_left = [&](const Corner& c) { return c.x < middle_x; };
  const std::size_t lower = position(std::partition(at(cell.begin), at(cell.end), is_upper));
  const std::size_t upper_right = position(std::partition(at(cell.begin), at(lower), is_left));
  const std::size_t lower_right = position(std::partition(at(lower), at(cell.end), is_left));
  const int depth = cell.depth + 1;
  std::vector<Cell> quarters{{cell.left, cell.top, middle_x, middle_y, cell.begin, upper_right, depth},
                             {middle_x, cell.top, cell.right, middle_y, upper_right, lower, depth},
                             {cell.left, middle_y, middle_x, cell.bottom, lower, lower_right, depth},
                             {middle_x, middle_y, cell.right, cell.bottom, lower_right, cell.end, depth}};
  std::erase_if(quarters, [](const Cell& quarter) { return quarter.size() == 0; });
  return quarters;
}

/// Starts with cells that are about square, so that quarters are too.
std::vector<Cell> root_cells(std::vector<Corner>& corners, const cv::Rect& area) {
  const int columns =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(area.width) / std::max(1, area.height))));
  const float width = static_cast<float>(area.width) / static_cast<float>(columns);
  const auto left = static_cast<float>(area.x), top = static_cast<float>(area.y);
  std::vector<Cell> roots;
  std::size_t begin = 0;
  for (int column = 0; column < columns; ++column) {
    const float cell_left = left + width * static_cast<float>(column), cell_right = cell_left + width;
    const auto first = corners.begin() + static_cast<std::ptrdiff_t>(begin);
    const bool last = column + 1 == columns;
    const auto last_inside =
        std::partition(first, corners.end(), [&](const Corner& c) { return last || c.x < cell_right; });
    const auto end = static_cast<std::size_t>(last_inside - corners.begin());
    if (end > begin)
      roots.push_back({cell_left, top, cell_right, top + static_cast<float>(area.height), begin, end, 0});
    begin = end;
  }
  return roots;
}

Corner strongest(const std::vector<Corner>& corners, const Cell& cell) {
  const auto first = corners.begin() + static_cast<std::ptrdiff_t>(cell.begin);
  const auto last = corners.begin() + static_cast<std::ptrdiff_t>(cell.end);
  return *std::max_element(first, last, [](const Corner& a, const Corner& b) { return a.response < b.response; });
}

}  // namespace

std::vector<Corner> detect_corners(const cv::Mat& grey, const OrbConfig& config) {
  std::vector<Corner> corners;
  const cv::Rect usable(kBorderPx, kBorderPx, grey.cols - 2 * kBorderPx, grey.rows - 2 * kBorderPx);
  if (usable.width <= 0 || usable.height <= 0) return corners;

  Scored level{fast_scores(grey, usable, std::min(config.fast_threshold, config.fast_threshold_low)), {}};
  level.peaks = peaks_of(level.scores, usable);
  append_corners(level, usable, config.fast_threshold, corners);
  const CellGrid grid(usable, config.cell_px);
  std::vector<char> occupied(static_cast<std::size_t>(grid.columns * grid.rows), 0);
  for (const Corner& corner : corners) occupied[grid.index(corner)] = 1;

  for (int row = 0; row < grid.rows; ++row) {
    const char* cells = &occupied[static_cast<std::size_t>(row * grid.columns)];
    for (int begin = 0; begin < grid.columns; ++begin) {
      if (cells[begin] != 0) continue;
      int end = begin;  // a run of empty cells is one area
      while (end < grid.columns && cells[end] == 0) ++end;
      const cv::Rect run(grid.left(begin), grid.top(row), grid.left(end) - grid.left(begin),
                         grid.top(row + 1) - grid.top(row));
      append_corners(level, run, config.fast_threshold_low, corners);
      begin = end;
    }
  }
  return corners;
}

std::vector<Corner> spread_corners(std::vector<Corner> corners, const cv::Rect& area, int wanted) {
  if (wanted <= 0) return {};
  constexpr int kMaxDepth = 16;  // corners on one spot cannot be separated: do not split for ever
  std::priority_queue<Cell, std::vector<Cell>, SplitsLater> open;
  std::vector<Cell> done;
  const auto place = [&](const Cell& cell) {
    if (cell.size() == 1 || cell.depth >= kMaxDepth) {
      done.push_back(cell);
    } else {
      open.push(cell);
    }
  };
  for (const Cell& root : root_cells(corners, area)) place(root);
  while (!open.empty() && static_cast<int>(open.size() + done.size()) < wanted) {
    const Cell cell = open.top();
    open.pop();
    for (const Cell& quarter : split(cell, corners)) place(quarter);
  }
  for (; !open.empty(); open.pop()) done.push_back(open.top());

  std::vector<Corner> spread;
  spread.reserve(done.size());
  for (const Cell& cell : done) spread.push_back(strongest(corners, cell));
  return spread;
}

}  // namespace rtd::filter
