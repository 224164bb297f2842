// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/plot/colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rtd::plot {
namespace {

using Rgb = std::array<double, 3>;
constexpr std::array<Rgb, 5> kErrorStops{
    {{35, 80, 160}, {38, 148, 150}, {120, 178, 70}, {232, 155, 40}, {196, 32, 38}}};

}  // namespace

std::string error_colour(double fraction) {
  const double t = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 1.0;
  const double position = t * (kErrorStops.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(position), kErrorStops.size() - 2);
  const auto mix = [&](std::size_t channel) {
    return std::lround(
        std::lerp(kErrorStops[below][channel], kErrorStops[below + 1][channel], position - static_cast<double>(below)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

}  // namespace rtd::plot
