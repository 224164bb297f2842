// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rtd::vision {

/// One detected object: an axis-parallel box in pixels of the camera's own image.
struct Detection {
  std::string class_name;                                 ///< COCO name, e.g. "person"
  float score = 0;                                        ///< [0, 1]
  float x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< top-left corner and size
};

/// Detections as pixels: which of them each place of the camera's own (distorted) image belongs to, on a grid of
/// kMaskStepPx. A detection that no place is labelled with has no mask.
struct PersonMasks {
  int columns = 0, rows = 0;         ///< image size / kMaskStepPx, rounded up; 0 = no masks
  std::vector<std::uint8_t> labels;  ///< row-major; 0 = none, n = detection n - 1 of the same frame

  bool empty() const { return labels.empty(); }
  /// The label of a place, ends included; 0 outside.
  std::uint8_t at(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return 0;
    return labels[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
};

/// Pixels per label, along rows and columns: the cells of the filter.
inline constexpr int kMaskStepPx = 4;
/// As many detections as labels can name.
inline constexpr std::size_t kMaxMasks = 255;

}  // namespace rtd::vision
