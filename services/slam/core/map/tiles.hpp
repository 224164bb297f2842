// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bitset>

#include "services/slam/core/map/frame.hpp"

namespace rtd::slam {

inline constexpr int kTileColumns = 8, kTileRows = 6;
inline constexpr std::size_t kTiles = static_cast<std::size_t>(kTileColumns) * kTileRows;

/// Which of the tiles of an image are meant, row by row.
using Tiles = std::bitset<kTiles>;

/// The tile in which a pixel is; those outside the image count for the nearest one.
inline std::size_t tile_of(const Frame& frame, double u_px, double v_px) {
  const int column = std::clamp(static_cast<int>(u_px * kTileColumns / frame.width_px), 0, kTileColumns - 1);
  const int row = std::clamp(static_cast<int>(v_px * kTileRows / frame.height_px), 0, kTileRows - 1);
  return static_cast<std::size_t>(row * kTileColumns + column);
}

}  // namespace rtd::slam
