// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "services/filter/core/orb/corner_detector.hpp"

namespace rtd::filter {

/// Picks about `wanted` corners (at most wanted + 2) spread over `area`: the area is quartered, coarse cells and among
/// those the fullest first, until there are `wanted` non-empty cells; each gives its strongest corner. Deterministic.
std::vector<Corner> spread_corners(std::vector<Corner> corners, const cv::Rect& area, int wanted);

}  // namespace rtd::filter
