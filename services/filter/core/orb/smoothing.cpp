// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/smoothing.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "common/vision/lanes.hpp"

namespace rtd::filter {
namespace {

constexpr int kReachPx = 3;
constexpr std::array<int, kReachPx + 1> kWeights{56, 48, 34, 18};  // by distance; the sum of all seven is 256
constexpr int kBias = 1 << 15;                                     // of the sums over rows, which then fit in 16 bits
constexpr int kUnbias = 256 * kBias + (1 << 15);                   // and rounds to the nearest

using Rows = std::array<const std::uint8_t*, 2 * kReachPx + 1>;

/// Exact sums, less the bias.
RTD_INLINE void add_rows(const Rows& rows, int columns, std::int16_t* __restrict sums) {
  const auto [a, b, c, d, e, f, g] = rows;
  for (int x = 0; x < columns; ++x) {
    sums[x] = static_cast<std::int16_t>(kWeights[3] * (a[x] + g[x]) + kWeights[2] * (b[x] + f[x]) +
                                        kWeights[1] * (c[x] + e[x]) + kWeights[0] * d[x] - kBias);
  }
}

/// `sums` begins kReachPx before the first column. Rounded to the nearest grey value.
void add_columns(const std::int16_t* __restrict sums, int columns, std::uint8_t* __restrict to) {
  for (int x = 0; x < columns; ++x) {
    const std::int16_t* s = sums + x;
    const int sum =
        kWeights[3] * (s[0] + s[6]) + kWeights[2] * (s[1] + s[5]) + kWeights[1] * (s[2] + s[4]) + kWeights[0] * s[3];
    to[x] = static_cast<std::uint8_t>((sum + kUnbias) >> 16);
  }
}

void add_rows_16(const Rows& rows, int columns, std::int16_t* sums) {
  add_rows(rows, columns, sums);
}

#if defined(__x86_64__)
RTD_AVX2 void add_rows_32(const Rows& rows, int columns, std::int16_t* sums) {
  add_rows(rows, columns, sums);
}

constexpr int kColumnBlock = 16;

/// Both weights for each pair of neighbours.
RTD_AVX2 RTD_INLINE __m256i weight_pair(int first, int second) {
  return _mm256_set1_epi32(first | second << 16);
}

RTD_AVX2 RTD_INLINE __m256i pairs_at(const std::int16_t* sums) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(sums));
}
/// The sums (of 32 bits) for every second column, from the first seven on.
RTD_AVX2 RTD_INLINE __m256i every_second(const std::int16_t* seven) {
  const __m256i left = _mm256_add_epi32(_mm256_madd_epi16(pairs_at(seven), weight_pair(kWeights[3], kWeights[2])),
                                        _mm256_madd_epi16(pairs_at(seven + 2), weight_pair(kWeights[1], kWeights[0])));
  const __m256i right = _mm256_add_epi32(_mm256_madd_epi16(pairs_at(seven + 4), weight_pair(kWeights[1], kWeights[2])),
                                         _mm256_madd_epi16(pairs_at(seven + 6), weight_pair(kWeights[3], 0)));
  return _mm256_add_epi32(_mm256_add_epi32(left, right), _mm256_set1_epi32(kUnbias));
}

/// As add_columns(), for at least a block; the last block may overlap the one before.
RTD_AVX2 void add_columns_32(const std::int16_t* sums, int columns, std::uint8_t* to) {
  for (int next = 0; next < columns; next += kColumnBlock) {
    const int x = std::min(next, columns - kColumnBlock);
    const __m256i even = _mm256_srli_epi32(every_second(sums + x), 16), odd = every_second(sums + x + 1);
    const __m256i grey = _mm256_blend_epi16(even, odd, 0xAA);  // the upper half of each odd sum
    const __m256i bytes = _mm256_permute4x64_epi64(_mm256_packus_epi16(grey, grey), 0b1000);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + x), _mm256_castsi256_si128(bytes));
  }
}
#endif

int mirrored(int position, int count) {
  if (position >= 0 && position < count) return position;
  return cv::borderInterpolate(position, count, cv::BORDER_REFLECT_101);
}

void mirror_ends(std::vector<std::int16_t>& sums, int columns) {
  const auto at = [&](int x) -> std::int16_t& { return sums[static_cast<std::size_t>(x + kReachPx)]; };
  for (int i = 1; i <= kReachPx; ++i) {
    at(-i) = at(mirrored(-i, columns));
    at(columns - 1 + i) = at(mirrored(columns - 1 + i, columns));
  }
}

}  // namespace

void smooth(const cv::Mat& grey, cv::Mat& smoothed) {
  smoothed.create(grey.size(), CV_8UC1);
  auto rows_into = add_rows_16;
  auto columns_into = add_columns;
#if defined(__x86_64__)
  if (vision::wide_vectors() && grey.cols >= kColumnBlock) {
    rows_into = add_rows_32;
    columns_into = add_columns_32;
  }
#endif
  std::vector<std::int16_t> sums(static_cast<std::size_t>(grey.cols + 2 * kReachPx + 1));  // one more: whole vectors
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
