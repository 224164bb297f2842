// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/brief.hpp"

#include <cmath>
#include <cstring>

#include "common/vision/lanes.hpp"
#include "services/filter/core/orb/corners.hpp"

namespace rtd::filter {
namespace {

// Every computation on pixels is made twice, for two widths of vectors.

constexpr std::size_t kSide = 2 * kPatchRadiusPx + 2;  // one column more than the disc has: whole vectors

/// -1 (all bits) inside the disc, 0 outside, by distance of the row from the centre; columns from -kPatchRadiusPx.
constexpr std::array<std::array<std::int16_t, kSide>, kPatchRadiusPx + 1> kDisc = [] {
  std::array<std::array<std::int16_t, kSide>, kPatchRadiusPx + 1> disc{};
  for (int v = 0; v <= kPatchRadiusPx; ++v) {
    for (int u = -kPatchRadiusPx; u <= kPatchRadiusPx; ++u) {
      if (u * u + v * v > kPatchRadiusPx * (kPatchRadiusPx + 1)) continue;
      disc[static_cast<std::size_t>(v)][static_cast<std::size_t>(u + kPatchRadiusPx)] = -1;
    }
  }
  return disc;
}();

struct Moments {
  int m10, m01;
};

/// Sums of 16 bits by column, exact: at most 31 x 255 grey values, and (1 + ... + 15) x 255 for the moment over rows.
RTD_INLINE Moments moments(const std::uint8_t* __restrict centre, std::ptrdiff_t step) {
  std::array<std::int16_t, kSide> grey, by_row{};
  const std::uint8_t* middle = centre - kPatchRadiusPx;
  for (std::size_t i = 0; i < kSide; ++i) grey[i] = static_cast<std::int16_t>(middle[i] & kDisc[0][i]);
  for (int v = 1; v <= kPatchRadiusPx; ++v) {
    const std::uint8_t *above = middle - v * step, *below = middle + v * step;
    const auto& inside = kDisc[static_cast<std::size_t>(v)];
    for (std::size_t i = 0; i < kSide; ++i) {
      grey[i] = static_cast<std::int16_t>(grey[i] + ((below[i] + above[i]) & inside[i]));
      by_row[i] = static_cast<std::int16_t>(by_row[i] + v * ((below[i] - above[i]) & inside[i]));
    }
  }
  Moments sums{0, 0};
  for (std::size_t i = 0; i < kSide; ++i) {
    sums.m10 += (static_cast<int>(i) - kPatchRadiusPx) * grey[i];
    sums.m01 += by_row[i];
  }
  return sums;
}

Moments moments_16(const std::uint8_t* centre, std::ptrdiff_t step) {
  return moments(centre, step);
}
RTD_AVX2 Moments moments_32(const std::uint8_t* centre, std::ptrdiff_t step) {
  return moments(centre, step);
}

using Offsets = std::array<std::int32_t, 2 * BriefPattern::kBits>;

/// Where the points of the rotated pattern lie in memory, from the corner on.
RTD_INLINE void rotate(float cosine, float sine, int step, Offsets& offsets) {
  const BriefPattern& pattern = brief_pattern();
  constexpr float kBias = 64.5F;  // makes truncation round to nearest, also below zero
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const int dx = static_cast<int>(pattern.x[i] * cosine - pattern.y[i] * sine + kBias) - 64;
    const int dy = static_cast<int>(pattern.x[i] * sine + pattern.y[i] * cosine + kBias) - 64;
    offsets[i] = dy * step + dx;
  }
}

void rotate_16(float cosine, float sine, int step, Offsets& offsets) {
  rotate(cosine, sine, step, offsets);
}
RTD_AVX2 void rotate_32(float cosine, float sine, int step, Offsets& offsets) {
  rotate(cosine, sine, step, offsets);
}

}  // namespace

float centroid_angle_rad(const cv::Mat& grey, cv::Point centre) {
  const auto moments_at = vision::wide_vectors() ? moments_32 : moments_16;
  const auto [m10, m01] = moments_at(grey.ptr(centre.y) + centre.x, static_cast<std::ptrdiff_t>(grey.step));
  return std::atan2(static_cast<float>(m01), static_cast<float>(m10));
}

msg::Descriptor rotated_brief(const cv::Mat& smoothed, cv::Point centre, float angle_rad) {
  Offsets offsets;
  const auto rotate_pattern = vision::wide_vectors() ? rotate_32 : rotate_16;
  rotate_pattern(std::cos(angle_rad), std::sin(angle_rad), static_cast<int>(smoothed.step), offsets);
  const std::uint8_t* origin = smoothed.ptr<std::uint8_t>(centre.y) + centre.x;
  msg::Descriptor descriptor{};
  for (std::size_t byte = 0; byte < descriptor.size(); ++byte) {
    unsigned bits = 0;
    for (std::size_t bit = 0; bit < 8; ++bit) {
      const std::size_t i = 2 * (8 * byte + bit);
      bits |= static_cast<unsigned>(origin[offsets[i]] < origin[offsets[i + 1]]) << bit;
    }
    descriptor[byte] = static_cast<std::uint8_t>(bits);
  }
  return descriptor;
}

}  // namespace rtd::filter
