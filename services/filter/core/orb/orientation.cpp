// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/orientation.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "services/filter/core/orb/corner_detector.hpp"

namespace rtd::filter {
namespace {

constexpr int kSide = 2 * kPatchRadiusPx + 1;

/// Weights of the disc, row by row and of full width, so that the compiler can use vector instructions.
struct DiscWeights {
  std::array<std::array<std::int16_t, kSide>, kSide> column{};  ///< u inside the disc, 0 outside
  std::array<std::array<std::int16_t, kSide>, kSide> inside{};  ///< 1 inside the disc, 0 outside
};

constexpr DiscWeights make_disc() {
  DiscWeights disc;
  for (int v = -kPatchRadiusPx; v <= kPatchRadiusPx; ++v) {
    for (int u = -kPatchRadiusPx; u <= kPatchRadiusPx; ++u) {
      if (u * u + v * v > kPatchRadiusPx * (kPatchRadiusPx + 1)) continue;
      const auto row = static_cast<std::size_t>(v + kPatchRadiusPx), col = static_cast<std::size_t>(u + kPatchRadiusPx);
      disc.column[row][col] = static_cast<std::int16_t>(u);
      disc.inside[row][col] = 1;
    }
  }
  return disc;
}

constexpr DiscWeights kDisc = make_disc();

}  // namespace

float centroid_angle_rad(const cv::Mat& grey, cv::Point centre) {
  int m10 = 0, m01 = 0;
  for (int v = -kPatchRadiusPx; v <= kPatchRadiusPx; ++v) {
    const std::uint8_t* pixels = grey.ptr<std::uint8_t>(centre.y + v) + centre.x - kPatchRadiusPx;
    const auto& column = kDisc.column[static_cast<std::size_t>(v + kPatchRadiusPx)];
    const auto& inside = kDisc.inside[static_cast<std::size_t>(v + kPatchRadiusPx)];
    int row_sum = 0;
    for (std::size_t i = 0; i < kSide; ++i) {
      const auto value = static_cast<std::int16_t>(pixels[i]);
      m10 += column[i] * value;
      row_sum += inside[i] * value;
    }
    m01 += v * row_sum;
  }
  return std::atan2(static_cast<float>(m01), static_cast<float>(m10));
}

}  // namespace rtd::filter
