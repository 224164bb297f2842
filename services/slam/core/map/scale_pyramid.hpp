// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace rtd::slam {

/// The image pyramid behind the features: octave k is 1.2^k times smaller.
inline constexpr int kOctaves = 8;
inline constexpr double kScaleFactor = 1.2;

inline constexpr std::array<double, kOctaves> kOctaveScale = [] {
  std::array<double, kOctaves> scale{};
  double value = 1;
  for (double& s : scale) {
    s = value;
    value *= kScaleFactor;
  }
  return scale;
}();

/// Standard deviation of a keypoint of this octave, px of the full image.
inline double sigma_px(int octave) {
  return kOctaveScale[static_cast<std::size_t>(octave)];
}

/// Octave in which a landmark appears at `distance_m` when octave 0 shows it at `max_distance_m`.
inline int predict_octave(double max_distance_m, double distance_m) {
  const double levels = std::log(max_distance_m / distance_m) / std::log(kScaleFactor);
  return std::clamp(static_cast<int>(std::ceil(levels)), 0, kOctaves - 1);
}

}  // namespace rtd::slam
