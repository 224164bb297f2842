// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/dynamic_mask.hpp"

#include <algorithm>
#include <cstddef>

namespace rtd::dense {
namespace {

/// Largest value within `radius` along one axis: `count` values, `step` apart.
void grow_line(const std::uint8_t* in, std::uint8_t* out, int count, int step, int radius) {
  for (int i = 0; i < count; ++i) {
    std::uint8_t largest = 0;
    for (int k = std::max(0, i - radius); k <= std::min(count - 1, i + radius); ++k) {
      largest = std::max(largest, in[static_cast<std::ptrdiff_t>(k) * step]);
    }
    out[static_cast<std::ptrdiff_t>(i) * step] = largest;
  }
}

}  // namespace

std::uint8_t DynamicMask::at(float u_px, float v_px, int width_px, int height_px) const {
  if (!(u_px >= 0 && v_px >= 0)) return kUnknown;
  const int column = static_cast<int>(u_px * static_cast<float>(columns) / static_cast<float>(width_px));
  const int row = static_cast<int>(v_px * static_cast<float>(rows) / static_cast<float>(height_px));
  if (column >= columns || row >= rows) return kUnknown;
  return cells[static_cast<std::size_t>(row * columns + column)];
}

DynamicMask grow(const DynamicMask& mask, int radius) {
  DynamicMask wide = mask, result = mask;
  for (int row = 0; row < mask.rows; ++row) {
    const std::ptrdiff_t first = std::ptrdiff_t{row} * mask.columns;
    grow_line(mask.cells.data() + first, wide.cells.data() + first, mask.columns, 1, radius);
  }
  for (int column = 0; column < mask.columns; ++column) {
    grow_line(wide.cells.data() + column, result.cells.data() + column, mask.rows, mask.columns, radius);
  }
  return result;
}

DynamicMask all_static() {
  return {1, 1, {DynamicMask::kStatic}};
}

}  // namespace rtd::dense
