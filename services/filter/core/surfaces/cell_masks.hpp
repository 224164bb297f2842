// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/vision/detection.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// The pixels of one object, kept with the box in which they were found, so that they can move with it.
class BoxMask {
 public:
  BoxMask() = default;
  /// Empty when no place has the label, or when there are not as many labels as places.
  BoxMask(const vision::PersonMasks& masks, std::uint8_t label, const vision::Detection& box);

  bool empty() const { return places_.empty(); }
  /// Does the pixel of the camera's own image belong to the object, whose box is `now`? False without a mask.
  bool covers(const Eigen::Vector2d& raw_px, const vision::Detection& now) const;

 private:
  vision::Detection box_;
  int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  ///< part of the grid of labels that has this one
  std::vector<std::uint8_t> places_;                 ///< row-major; not 0 = the object
};

/// Operations on masks of grid cells: one value per cell, 0 = not set.
using CellMask = std::vector<std::uint8_t>;

/// The largest value within `radius` cells (square) of each. T: std::uint8_t, std::int16_t or float.
template <typename T>
std::vector<T> largest_near(const GridShape& shape, std::vector<T> values, int radius);
/// The smallest one.
std::vector<float> smallest_near(const GridShape& shape, std::vector<float> values, int radius);

/// Cells within `radius` cells (square) of a set one; the larger value wins.
CellMask dilate(const GridShape& shape, CellMask cells, int radius);

/// Per cell the larger value of two masks.
CellMask united(CellMask a, const CellMask& b);

/// The set cells most of whose 3x3 neighbourhood is set: noise along depth edges is one cell wide and vanishes.
CellMask compact(const GridShape& shape, const CellMask& cells);

/// Clears the connected regions (4 neighbours) for which `keep` returns false; `keep` receives the cells of a region.
CellMask keep_regions(const GridShape& shape, CellMask cells, const std::function<bool(const std::vector<int>&)>& keep);

}  // namespace rtd::filter
