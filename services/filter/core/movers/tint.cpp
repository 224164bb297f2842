// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/movers/tint.hpp"

#include <algorithm>

namespace rtd::filter {

std::uint8_t tint_of(const cv::Vec3b& bgr) {
  constexpr int kHues = 8, kPartDeg = 360 / kHues;  // red lies in the middle of a part
  constexpr int kGrey = 40, kStrong = 110, kBlack = 30, kDark = 60, kBright = 140;
  const int blue = bgr[0], green = bgr[1], red = bgr[2];
  const int value = std::max({blue, green, red}), range = value - std::min({blue, green, red});
  const int saturation = value > 0 ? 255 * range / value : 0;
  if (saturation < kGrey || value < kBlack)
    return static_cast<std::uint8_t>(2 * kHues + (value < kDark ? 0 : value < kBright ? 1 : 2));
  int hue_deg = 240 + 60 * (red - green) / range;
  if (value == red)
    hue_deg = 60 * (green - blue) / range;
  else if (value == green)
    hue_deg = 120 + 60 * (blue - red) / range;
  const int hue = (hue_deg + 360 + kPartDeg / 2) % 360 / kPartDeg;
  return static_cast<std::uint8_t>(2 * hue + (saturation >= kStrong ? 1 : 0));
}

double unlike(const TintShares& a, const TintShares& b) {
  if (a.isZero() || b.isZero()) return 0;
  return 1 - a.cwiseProduct(b).cwiseSqrt().sum();
}

}  // namespace rtd::filter
