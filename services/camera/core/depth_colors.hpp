// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace rtd::camera {

/// Range of depth_preview(), m; what is nearer or farther has the colour of its end.
inline constexpr double kPreviewNear_m = 0.4, kPreviewFar_m = 6;

/// A depth image (CV_16UC1) as colours (8-bit BGR) from `nearest` (red) to `farthest` (blue), in its units; black where
/// there is none.
cv::Mat depth_colors(const cv::Mat& depth, double nearest, double farthest);

/// The same from kPreviewNear_m to kPreviewFar_m, so that a colour always means the same, and at most 320 px wide.
cv::Mat depth_preview(const cv::Mat& depth, double depth_scale_m);

}  // namespace rtd::camera
