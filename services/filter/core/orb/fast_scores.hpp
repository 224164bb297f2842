// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace rtd::filter {

inline constexpr int kFastRadiusPx = 3;  ///< of the circle of FAST-9-16

/// Scores of FAST-9-16 (Rosten & Drummond 2006), docs/theory/orb.md: a pixel is a corner at all thresholds below its
/// score. CV_8UC1 of the size of `grey` (CV_8UC1), set in `area`, which keeps kFastRadiusPx from the border of the
/// image: 0 where the score is not above `threshold`; and 0 in the pixels next to it.
cv::Mat fast_scores(const cv::Mat& grey, const cv::Rect& area, int threshold);

/// Of scores that are set in `area` and next to it, those that are above all eight neighbours, 0 elsewhere. Set in
/// `area`.
cv::Mat peaks_of(const cv::Mat& scores, const cv::Rect& area);

}  // namespace rtd::filter
