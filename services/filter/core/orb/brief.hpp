// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "common/msg/features.hpp"

namespace rtd::filter {

/// Angle (rad, (-pi, pi], x right, y down) from a corner to the intensity centroid of the disc of kPatchRadiusPx around
/// it: atan2(m01, m10), Rosin 1999, docs/theory/orb.md Eq. (2). The corner keeps kBorderPx from the image's border.
float centroid_angle_rad(const cv::Mat& grey, cv::Point centre);

/// The 256 point pairs that rotated BRIEF compares, as offsets (px) from the corner, before rotation.
///
/// Our own table, made from a fixed seed: Gaussian pairs, taken greedily so that no two comparisons are expected to be
/// redundant under a natural image's autocorrelation; docs/theory/orb.md Eq. (3)-(4).
struct BriefPattern {
  static constexpr std::size_t kBits = 256;
  std::array<float, 2 * kBits> x{}, y{};  ///< points 2k and 2k+1 are compared for bit k
};
const BriefPattern& brief_pattern();

/// Descriptor of the patch around `centre` in a smoothed image, the pattern rotated by `angle_rad`.
msg::Descriptor rotated_brief(const cv::Mat& smoothed, cv::Point centre, float angle_rad);

}  // namespace rtd::filter
