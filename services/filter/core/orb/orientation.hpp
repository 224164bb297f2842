// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace rtd::filter {

/// Angle (rad, (-pi, pi], x right, y down) from a corner to the intensity centroid of the disc of kPatchRadiusPx around
/// it: atan2(m01, m10), Rosin 1999, docs/theory/orb.md Eq. (2). The disc must lie inside the image.
float centroid_angle_rad(const cv::Mat& grey, cv::Point centre);

}  // namespace rtd::filter
