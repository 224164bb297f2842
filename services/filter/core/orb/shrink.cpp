// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/shrink.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/vision/lanes.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

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

constexpr int kBlock = 8, kLoaded = 16;  // pixels made at a time, and pixels looked at for them
constexpr double kMinScale = 1.02;       // so that the last pixel lies between two
constexpr double kMaxScale = 1.8;        // so that the pixels looked at suffice

/// Between which two pixels one lies, and their weights: 2048 together.
struct Between {
  int first;
  std::int16_t weight_first, weight_second;
};

std::vector<Between> positions(int from, int to) {
  constexpr float kUnit = 2048;
  const double scale = 1.0 / (static_cast<double>(to) / from);
  std::vector<Between> all;
  all.reserve(static_cast<std::size_t>(to));
  for (int i = 0; i < to; ++i) {
    const auto position = static_cast<float>((i + 0.5) * scale - 0.5);
    const int first = static_cast<int>(std::floor(position));
    const float second = position - static_cast<float>(first);
    all.push_back({first, cv::saturate_cast<std::int16_t>((1.0F - second) * kUnit),
                   cv::saturate_cast<std::int16_t>(second * kUnit)});
  }
  return all;
}

/// Eight neighbours in a row of the result.
struct Block {
  std::array<std::uint8_t, 2 * kBlock> picked;  ///< of the pixels looked at, two each
  std::array<std::int16_t, 2 * kBlock> weights;
  int begin, looked_at;  ///< where the result and the pixels looked at begin
};

std::vector<Block> blocks_of(const std::vector<Between>& columns, int from_columns) {
  const int count = static_cast<int>(columns.size());
  std::vector<Block> blocks;
  for (int x = 0; x < count; x += kBlock) {
    Block block;
    block.begin = std::min(x, count - kBlock);  // the last block overlaps the one before
    block.looked_at = std::min(columns[static_cast<std::size_t>(block.begin)].first, from_columns - kLoaded);
    for (int i = 0; i < kBlock; ++i) {
      const Between& column = columns[static_cast<std::size_t>(block.begin + i)];
      const auto at = static_cast<std::size_t>(2 * i);
      block.picked[at] = static_cast<std::uint8_t>(column.first - block.looked_at);
      block.picked[at + 1] = static_cast<std::uint8_t>(column.first + 1 - block.looked_at);
      block.weights[at] = column.weight_first;
      block.weights[at + 1] = column.weight_second;
    }
    blocks.push_back(block);
  }
  return blocks;
}

#if defined(__SSE4_1__)
template <class Number>
__m128i load(const Number* from) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
}

/// A row of the source at the columns of the result, in units of 1/128.
void resample(const std::uint8_t* row, const std::vector<Block>& blocks, std::int16_t* to) {
  for (const Block& block : blocks) {
    const __m128i pairs = _mm_shuffle_epi8(load(row + block.looked_at), load(block.picked.data()));
    const __m128i low = _mm_madd_epi16(_mm_cvtepu8_epi16(pairs), load(block.weights.data()));
    const __m128i high =
        _mm_madd_epi16(_mm_cvtepu8_epi16(_mm_srli_si128(pairs, 8)), load(block.weights.data() + kBlock));
    const __m128i sums = _mm_packs_epi32(_mm_srai_epi32(low, 4), _mm_srai_epi32(high, 4));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + block.begin), sums);
  }
}
#else
/// The same numbers without SSE.
void resample(const std::uint8_t* row, const std::vector<Block>& blocks, std::int16_t* to) {
  for (const Block& block : blocks) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint8_t* const seen = row + block.looked_at;
      const int sum =
          seen[block.picked[2 * i]] * block.weights[2 * i] + seen[block.picked[2 * i + 1]] * block.weights[2 * i + 1];
      to[static_cast<std::size_t>(block.begin) + i] = static_cast<std::int16_t>(sum >> 4);
    }
  }
}
#endif

RTD_INLINE void blend(const std::int16_t* __restrict first, const std::int16_t* __restrict second, const Between& row,
                      int columns, std::uint8_t* __restrict to) {
  const std::int16_t weight_first = row.weight_first, weight_second = row.weight_second;
  for (int x = 0; x < columns; ++x) {
    const auto a = static_cast<std::int16_t>((weight_first * first[x]) >> 16);
    const auto b = static_cast<std::int16_t>((weight_second * second[x]) >> 16);
    to[x] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(a + b + 2) >> 2U);
  }
}

void blend_16(const std::int16_t* first, const std::int16_t* second, const Between& row, int columns,
              std::uint8_t* to) {
  blend(first, second, row, columns, to);
}
RTD_AVX2 void blend_32(const std::int16_t* first, const std::int16_t* second, const Between& row, int columns,
                       std::uint8_t* to) {
  blend(first, second, row, columns, to);
}

/// Whether every pixel of the result lies between pixels of the source, whose neighbours fit into a block.
bool fits(const cv::Mat& from, cv::Size size) {
  const double scale_x = static_cast<double>(from.cols) / size.width,
               scale_y = static_cast<double>(from.rows) / size.height;
  return from.type() == CV_8UC1 && size.width >= kBlock && from.cols >= kLoaded && scale_x > kMinScale &&
         scale_x < kMaxScale && scale_y > kMinScale && scale_y < kMaxScale;
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

void shrink(const cv::Mat& from, cv::Size size, cv::Mat& to) {
  if (!fits(from, size)) return cv::resize(from, to, size, 0, 0, cv::INTER_LINEAR);
  to.create(size, CV_8UC1);
  const std::vector<Between> rows = positions(from.rows, size.height);
  const std::vector<Block> blocks = blocks_of(positions(from.cols, size.width), from.cols);
  std::array<std::vector<std::int16_t>, 2> resampled;  // rows of the source, even ones and odd ones
  for (auto& row : resampled) row.resize(static_cast<std::size_t>(size.width));
  const auto at = [&](int row) { return resampled[static_cast<std::size_t>(row % 2)].data(); };
  const auto blend_rows = vision::wide_vectors() ? blend_32 : blend_16;
  int next = 0;
  for (int y = 0; y < size.height; ++y) {
    const Between& row = rows[static_cast<std::size_t>(y)];
    for (next = std::max(next, row.first); next <= row.first + 1; ++next) resample(from.ptr(next), blocks, at(next));
    blend_rows(at(row.first), at(row.first + 1), row, size.width, to.ptr(y));
  }
}

}  // namespace rtd::filter
