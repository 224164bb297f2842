// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "common/msg/features.hpp"

namespace rtd::vision {

/// Where to look for a feature in an image.
struct SearchWindow {
  float u_px = 0, v_px = 0;  ///< centre, undistorted pixels
  float radius_px = 0;       ///< half side of the square window
  int min_octave = 0;        ///< both ends included
  int max_octave = 255;
};

/// Finds the features of one image near a pixel without looking at the others.
///
/// Buckets the undistorted positions in square cells; positions outside the image go to the nearest border cell, so
/// none is lost. Visits in a fixed order (row of cells, column, index). At most 65535 features (std::length_error).
/// At most kMaxCells cells a side, whatever the size says. Refers to `features`, which must outlive the grid.
class FeatureGrid {
 public:
  static constexpr int kMaxCells = 256;

  FeatureGrid() = default;
  FeatureGrid(std::span<const msg::Feature> features, int width_px, int height_px, int cell_px = 20);

  /// Calls visit(index) for every feature inside the window.
  template <class Visitor>
  void for_each(const SearchWindow& window, Visitor&& visit) const {
    if (columns_ == 0) return;
    const int first_column = column_of(window.u_px - window.radius_px),
              last_column = column_of(window.u_px + window.radius_px);
    const int first_row = row_of(window.v_px - window.radius_px), last_row = row_of(window.v_px + window.radius_px);
    for (int row = first_row; row <= last_row; ++row) {
      for (std::uint32_t i = cell_begin(row, first_column); i < cell_end(row, last_column); ++i) {
        if (inside(window, features_[indices_[i]])) visit(indices_[i]);
      }
    }
  }

  /// The same as a list.
  std::vector<std::uint32_t> find(const SearchWindow& window) const;

 private:
  static bool inside(const SearchWindow& window, const msg::Feature& feature) {
    return feature.octave >= window.min_octave && feature.octave <= window.max_octave &&
           std::abs(feature.u_px - window.u_px) <= window.radius_px &&
           std::abs(feature.v_px - window.v_px) <= window.radius_px;
  }
  int column_of(float u_px) const { return bucket(u_px, columns_); }
  int row_of(float v_px) const { return bucket(v_px, rows_); }
  int bucket(float position_px, int count) const {
    const float cell = position_px * inverse_cell_px_;
    return cell > 0 ? static_cast<int>(std::min(cell, static_cast<float>(count - 1))) : 0;  // 0 for NaN
  }
  std::uint32_t cell_begin(int row, int column) const {
    return starts_[static_cast<std::size_t>(row * columns_ + column)];
  }
  std::uint32_t cell_end(int row, int column) const {
    return starts_[static_cast<std::size_t>(row * columns_ + column) + 1];
  }

  std::span<const msg::Feature> features_;
  float inverse_cell_px_ = 0;
  int columns_ = 0, rows_ = 0;
  // 16 bits: every keyframe of a map keeps its grid.
  std::vector<std::uint16_t> starts_;   ///< first entry of each cell in indices_, one more at the end
  std::vector<std::uint16_t> indices_;  ///< features ordered by cell
};

/// Number of differing bits of two 256-bit descriptors.
inline int hamming_distance(const msg::Descriptor& a, const msg::Descriptor& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t x = 0, y = 0;
    std::memcpy(&x, a.data() + i, sizeof(x));
    std::memcpy(&y, b.data() + i, sizeof(y));
    distance += std::popcount(x ^ y);
  }
  return distance;
}

}  // namespace rtd::vision
