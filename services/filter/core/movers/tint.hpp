// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>

/// Colours by which moving objects are distinguished: hue in eight parts, pale or strong, and three greys. Brightness
/// counts only where there is no hue, because light and exposure change it.
namespace rtd::filter {

inline constexpr int kTints = 19;
/// How much of a surface has each tint, sum 1; all 0 = unknown.
using TintShares = Eigen::Matrix<double, kTints, 1>;

std::uint8_t tint_of(const cv::Vec3b& bgr);

/// Hellinger: 1 - sum sqrt(a b), 0 = the same, 1 = nothing in common; 0 if one of them is unknown.
double unlike(const TintShares& a, const TintShares& b);

}  // namespace rtd::filter
