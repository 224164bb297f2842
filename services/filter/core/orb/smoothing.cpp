// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/smoothing.hpp"

#include <array>
#include <cstdint>
#include <vector>

#include "common/vision/lanes.hpp"

namespace rtd::filter {
namespace {

constexpr int kReachPx = 3;
constexpr std::array<std::uint16_t, kReachPx + 1> kWeights{56, 48, 34, 18};  // by distance; the sum of all seven is 256

using Rows = std::array<const std::uint8_t*, 2 * kReachPx + 1>;

/// Sums of 16 bits, exact: at most 256 x 255.
RTD_INLINE void add_rows(const Rows& rows, int columns, std::uint16_t* __restrict sums) {
  const auto [a, b, c, d, e, f, g] = rows;
  for (int x = 0; x < columns; ++x) {
    sums[x] = static_cast<std::uint16_t>(kWeights[3] * (a[x] + g[x]) + kWeights[2] * (b[x] + f[x]) +
                                         kWeights[1] * (c[x] + e[x]) + kWeights[0] * d[x]);
  }
}

/// `sums` begins kReachPx before the first column. Rounded to the nearest grey value.
RTD_INLINE void add_columns(const std::uint16_t* __restrict sums, int columns, std::uint8_t* __restrict to) {
  constexpr std::uint32_t kHalf = 1U << 15U;
  for (int x = 0; x < columns; ++x) {
    const std::uint16_t* s = sums + x;
    const std::uint32_t sum = kWeights[3] * (std::uint32_t{s[0]} + s[6]) + kWeights[2] * (std::uint32_t{s[1]} + s[5]) +
                              kWeights[1] * (std::uint32_t{s[2]} + s[4]) + kWeights[0] * std::uint32_t{s[3]};
    to[x] = static_cast<std::uint8_t>((sum + kHalf) >> 16U);
  }
}

/// Both are made twice, for two widths of vectors.
void add_rows_16(const Rows& rows, int columns, std::uint16_t* sums) {
  add_rows(rows, columns, sums);
}
void add_columns_16(const std::uint16_t* sums, int columns, std::uint8_t* to) {
  add_columns(sums, columns, to);
}
RTD_AVX2 void add_rows_32(const Rows& rows, int columns, std::uint16_t* sums) {
  add_rows(rows, columns, sums);
}
RTD_AVX2 void add_columns_32(const std::uint16_t* sums, int columns, std::uint8_t* to) {
  add_columns(sums, columns, to);
}

int mirrored(int position, int count) {
  if (position >= 0 && position < count) return position;
  return cv::borderInterpolate(position, count, cv::BORDER_REFLECT_101);
}

void mirror_ends(std::vector<std::uint16_t>& sums, int columns) {
  const auto at = [&](int x) -> std::uint16_t& { return sums[static_cast<std::size_t>(x + kReachPx)]; };
  for (int i = 1; i <= kReachPx; ++i) {
    at(-i) = at(mirrored(-i, columns));
    at(columns - 1 + i) = at(mirrored(columns - 1 + i, columns));
  }
}

}  // namespace

void smooth(const cv::Mat& grey, cv::Mat& smoothed) {
  smoothed.create(grey.size(), CV_8UC1);
  const bool wide = vision::wide_vectors();
  const auto rows_into = wide ? add_rows_32 : add_rows_16;
  const auto columns_into = wide ? add_columns_32 : add_columns_16;
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(grey.cols + 2 * kReachPx));
  for (int y = 0; y < grey.rows; ++y) {
    Rows rows;
    for (int i = -kReachPx; i <= kReachPx; ++i)
      rows[static_cast<std::size_t>(i + kReachPx)] = grey.ptr(mirrored(y + i, grey.rows));
    rows_into(rows, grey.cols, sums.data() + kReachPx);
    mirror_ends(sums, grey.cols);
    columns_into(sums.data(), grey.cols, smoothed.ptr(y));
  }
}

}  // namespace rtd::filter
