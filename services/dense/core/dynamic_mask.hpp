// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rtd::dense {

/// What the filter says of the cells of one frame, in undistorted pixels.
struct DynamicMask {
  enum : std::uint8_t { kStatic = 0, kUnknown = 128, kDynamic = 255 };
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> cells;  ///< row by row; more than kUnknown = dynamic

  /// Value at an undistorted pixel of an image of this size; kUnknown outside the mask.
  std::uint8_t at(float u_px, float v_px, int width_px, int height_px) const;
};

/// The same with everything within `radius` cells (square) of a larger value raised to it.
DynamicMask grow(const DynamicMask& mask, int radius);

/// A mask of one cell that calls everything static.
DynamicMask all_static();

}  // namespace rtd::dense
