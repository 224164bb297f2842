// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "services/filter/core/config/filter_config.hpp"

namespace rtd::filter {

/// A FAST corner in pixels of its pyramid level.
struct Corner {
  float x = 0, y = 0;
  float response = 0;  ///< FAST score: the threshold at which it would vanish
};

/// Corners keep this distance from the border of their level, so that orientation and descriptor stay inside the image.
inline constexpr int kPatchRadiusPx = 15;
inline constexpr int kBorderPx = kPatchRadiusPx + 1;

/// FAST corners of one level: the usual threshold everywhere, the low one in the cells that stay empty, so that weakly
/// textured regions contribute too. Order: row of cells, strict before low threshold.
std::vector<Corner> detect_corners(const cv::Mat& grey, const OrbConfig& config);

/// Picks about `wanted` corners (at most wanted + 2) spread over `area`: the area is quartered, coarse cells and among
/// those the fullest first, until there are `wanted` non-empty cells; each gives its strongest corner. Deterministic.
std::vector<Corner> spread_corners(std::vector<Corner> corners, const cv::Rect& area, int wanted);

}  // namespace rtd::filter
