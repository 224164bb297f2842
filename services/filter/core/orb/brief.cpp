// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/brief.hpp"

#include <cmath>

#include "common/vision/lanes.hpp"
#include "services/filter/core/orb/corners.hpp"

namespace rtd::filter {
namespace {

/// The pairs ax, ay, bx, by that the rule of docs/theory/orb.md gives: tests/unit/filter/orb/brief_test.cpp has the
/// rule.
constexpr std::array<std::int8_t, 4 * BriefPattern::kBits> kPairs{
    11,  -7,  3,  5,   -3,  2,   -6,  11,  3,   -2,  -5,  1,   -1,  8,   4,   13,  5,   -8,  10,  1,   -3,  -9,  1,
    0,   -8,  2,  -5,  5,   -6,  3,   -5,  -2,  -13, -2,  9,   7,   -5,  -9,  1,   -11, 5,   3,   6,   8,   1,   9,
    5,   6,   -9, 0,   -11, -5,  0,   -2,  6,   -3,  -2,  6,   -7,  5,   11,  -2,  12,  2,   12,  -1,  6,   -1,  -8,
    -4,  -2,  -3, -1,  4,   -1,  0,   5,   -12, 1,   -10, -3,  -12, -3,  -8,  1,   -13, 6,   -9,  6,   9,   10,  9,
    7,   3,   4,  0,   -1,  11,  -3,  7,   4,   -4,  5,   -10, -8,  -10, -10, -3,  1,   5,   -3,  5,   3,   11,  -1,
    -7,  -14, 0,  -6,  -1,  3,   9,   -1,  10,  -6,  5,   -10, 7,   12,  4,   0,   3,   0,   -5,  -2,  -1,  -11, 3,
    -5,  -7,  8,  -6,  12,  -6,  -3,  9,   -9,  -8,  10,  -5,  8,   -11, -2,  -7,  -8,  -9,  2,   1,   0,   -3,  -11,
    -1,  -12, 6,  1,   7,   0,   2,   -10, 0,   -5,  2,   -1,  -9,  -6,  -3,  7,   0,   -11, 8,   -5,  -5,  12,  -4,
    0,   -5,  1,  -9,  9,   -4,  5,   -5,  8,   7,   13,  2,   3,   6,   7,   6,   4,   -2,  2,   -6,  4,   2,   -1,
    1,   5,   -6, 1,   -7,  -3,  -7,  2,   -6,  -6,  2,   -2,  1,   -5,  -4,  -3,  0,   5,   -5,  3,   -1,  6,   3,
    9,   0,   -9, 9,   -13, 2,   7,   -8,  -10, -1,  2,   4,   -7,  -3,  9,   1,   11,  5,   -6,  -2,  -7,  -7,  3,
    2,   -2,  7,  -3,  5,   1,   -12, 4,   -1,  3,   3,   8,   10,  4,   -13, -5,  -13, 6,   6,   14,  0,   12,  4,
    10,  -9,  5,  -9,  5,   1,   5,   -3,  8,   0,   9,   -4,  -1,  -8,  3,   -11, -4,  12,  11,  -2,  0,   14,  5,
    11,  4,   -9, -4,  -12, -12, 6,   0,   10,  -5,  7,   7,   9,   -4,  0,   -9,  4,   0,   4,   2,   12,  7,   11,
    3,   5,   1,  -8,  -9,  10,  -4,  9,   1,   8,   3,   9,   8,   2,   1,   -1,  4,   5,   -2,  2,   0,   -2,  -6,
    -12, -4,  -3, 6,   11,  9,   6,   -10, 2,   -10, -2,  7,   6,   7,   -4,  5,   6,   2,   3,   -4,  8,   -5,  13,
    7,   -2,  7,  -6,  -1,  -13, 1,   -8,  -4,  1,   -3,  5,   -3,  -4,  1,   -2,  -5,  6,   -1,  4,   4,   -7,  7,
    -4,  3,   -3, 0,   0,   1,   -4,  8,   -7,  -2,  -3,  3,   -7,  -2,  8,   -5,  3,   -8,  9,   -2,  13,  -4,  -3,
    -8,  -1,  -2, -7,  7,   -1,  -6,  10,  -9,  6,   -1,  5,   3,   5,   -7,  2,   -10, 5,   -1,  3,   -12, 3,   -2,
    13,  4,   4,  3,   1,   7,   -1,  13,  -2,  9,   -4,  -9,  -4,  -13, -4,  0,   13,  -5,  12,  -9,  -7,  -5,  -12,
    1,   2,   -3, 1,   -8,  -8,  6,   -4,  -1,  -3,  -4,  -6,  -1,  1,   -2,  -4,  4,   1,   2,   5,   -12, -7,  -4,
    -8,  -13, -5, 4,   0,   -6,  8,   -6,  -1,  9,   -2,  4,   -1,  -10, -7,  -6,  -4,  -7,  7,   8,   -11, 7,   0,
    3,   -2,  6,  10,  13,  -3,  0,   -11, -1,  -7,  -4,  0,   9,   3,   0,   14,  8,   -7,  -2,  10,  2,   -3,  -11,
    -2,  -7,  -5, -5,  -8,  -1,  -6,  -4,  -5,  -5,  -1,  12,  7,   9,   -9,  5,   1,   11,  8,   5,   12,  -8,  -1,
    -1,  -5,  -7, 2,   13,  3,   6,   -5,  -3,  9,   -2,  5,   -8,  2,   5,   5,   13,  -2,  -10, 3,   4,   -6,  1,
    -10, -5,  3,  -8,  7,   -2,  -2,  4,   -1,  -6,  5,   0,   -1,  -6,  -8,  -3,  3,   -8,  11,  11,  6,   1,   -3,
    12,  1,   7,  -10, 4,   1,   -2,  5,   8,   -2,  2,   -7,  -13, 1,   2,   3,   1,   -7,  -9,  10,  3,   9,   7,
    5,   12,  7,  8,   7,   2,   0,   -2,  3,   -5,  -1,  1,   -11, 10,  -3,  5,   -2,  9,   -6,  -9,  0,   1,   1,
    1,   6,   4,  -5,  -8,  5,   -3,  -13, 3,   -9,  1,   -2,  -7,  -5,  -6,  0,   0,   -5,  7,   4,   8,   -9,  -4,
    -9,  -9,  -6, 1,   -8,  10,  -7,  11,  -3,  -1,  -2,  -5,  -2,  -5,  -2,  5,   -13, -9,  5,   -4,  6,   6,   6,
    5,   13,  3,  -3,  -1,  -5,  4,   -13, 4,   -8,  2,   -4,  5,   0,   -2,  -4,  -2,  -10, -5,  13,  -5,  -11, 2,
    9,   -2,  7,  0,   6,   4,   9,   9,   8,   0,   11,  13,  5,   -2,  -9,  3,   7,   -3,  3,   5,   6,   10,  4,
    4,   13,  5,  -3,  9,   -10, 5,   -5,  -3,  -3,  2,   7,   5,   0,   1,   2,   -3,  -3,  -4,  1,   -13, -4,  -12,
    0,   -10, 1,  -7,  -2,  3,   -4,  1,   -8,  -12, 4,   -9,  1,   0,   8,   -11, -3,  -6,  9,   -6,  5,   -8,  4,
    -8,  -3,  7,  1,   12,  2,   3,   4,   8,   3,   4,   -3,  13,  -4,  0,   3,   2,   -1,  -9,  0,   -7,  12,  -4,
    -1,  -12, -4, -7,  -5,  -5,  -10, -8,  -2,  -3,  2,   4,   3,   -7,  7,   9,   1,   5,   0,   9,   0,   12,  -3,
    7,   2,   1,  0,   -1,  -7,  0,   -3,  -9,  -10, 2,   2,   2,   8,   1,   12,  1,   1,   -3,  4,   5,   4,   0,
    4,   -3,  10, 8,   4,   -3,  0,   6,   -6,  6,   2,   -1,  -11, 4,   -10, 8,   -6,  0,   -13, -11, 0,   -12, 0,
    -9,  -3,  10, 4,   9,   10,  7,   4,   7,   0,   -1,  7,   -3,  13,  -6,  6,   -4,  2,   -4,  -5,  0,   -7,  1,
    4,   0,   8,  -5,  -6,  -3,  -11, -3,  2,   0,   5,   8,   8,   8,   0,   -8,  -3,  -2,  13,  7,   8,   3,   8,
    5,   -9,  1,  -8,  4,   -13, -8,  -10, 11,  1,   -9,  -3,  10,  2,   7,   -1,  -3,  6,   -1,  1,   4,   6,   6,
    -1,  -8,  6,  -9,  1,   -4,  7,   -3,  -5,  -8,  -6,  -12, -5,  -12, 7,   -8,  10,  -4,  9,   -11, 8,   5,   -5,
    -8,  4,   7,  -9,  9,   -2,  -2,  -6,  10,  9,   -4,  2,   0,   -8,  -3,  -12, 13,  -5,  -10, 3,   -9,  7,   -5,
    2,   0,   3,  1,   0,   0,   6,   1,   -1,  3,   -5,  7,   5,   -9,  -6,  6,   -5,  7,   0,   -11, 6,   -4,  -3,
    5,   11,  0,  -1,  -2,  -13, 4,   -2,  -8,  1,   -4,  1};

constexpr BriefPattern make_pattern() {
  BriefPattern pattern;
  for (std::size_t i = 0; i < pattern.x.size(); ++i) {
    pattern.x[i] = kPairs[2 * i];
    pattern.y[i] = kPairs[2 * i + 1];
  }
  return pattern;
}

constexpr BriefPattern kPattern = make_pattern();

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

const BriefPattern& brief_pattern() {
  return kPattern;
}

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
