// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/fast_scores.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "common/vision/lanes.hpp"

// Vectors wider than the default instruction set's are only passed to inlined functions.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace rtd::filter {
namespace {

constexpr int kCircle = 16;

/// Pixels of the circle as distances in memory from its centre.
using Circle = std::array<std::ptrdiff_t, kCircle>;

Circle circle_of(const cv::Mat& grey) {
  constexpr std::array<int, kCircle> kX{0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr std::array<int, kCircle> kY{3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3};
  Circle circle;
  for (std::size_t k = 0; k < kCircle; ++k) circle[k] = kY[k] * static_cast<std::ptrdiff_t>(grey.step) + kX[k];
  return circle;
}

template <int kBytes>
struct ByteVector;
template <>
struct ByteVector<1> {
  using Bytes = std::uint8_t __attribute__((vector_size(1)));
};
template <>
struct ByteVector<16> {
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
};
template <>
struct ByteVector<32> {
  using Bytes = std::uint8_t __attribute__((vector_size(32)));
};

/// So many pixels at a time.
template <int kBytes>
struct Pixels : ByteVector<kBytes> {
  using typename ByteVector<kBytes>::Bytes;
  static constexpr int kCount = kBytes;

  static RTD_INLINE Bytes load(const std::uint8_t* from) {
    Bytes bytes;
    std::memcpy(&bytes, from, sizeof bytes);
    return bytes;
  }
  static RTD_INLINE void store(std::uint8_t* to, const Bytes& bytes) { std::memcpy(to, &bytes, sizeof bytes); }
  static RTD_INLINE Bytes lesser(const Bytes& a, const Bytes& b) { return a < b ? a : b; }
  static RTD_INLINE Bytes greater(const Bytes& a, const Bytes& b) { return a > b ? a : b; }
  /// The greater of brighter - centre and centre - darker, 0 where both are negative.
  static RTD_INLINE Bytes contrast(const Bytes& centre, const Bytes& brighter, const Bytes& darker) {
    return greater(greater(brighter, centre) - centre, centre - lesser(darker, centre));
  }
  /// The same, 0 where it is not above the threshold.
  static RTD_INLINE Bytes above(const Bytes& bytes, const Bytes& threshold) {
    return bytes & reinterpret_cast<Bytes>(bytes > threshold);
  }
  static RTD_INLINE bool any(const Bytes& bytes) {
    std::array<std::uint64_t, (kBytes + 7) / 8> eights{};
    std::memcpy(eights.data(), &bytes, sizeof bytes);
    std::uint64_t some = 0;
    for (const std::uint64_t eight : eights) some |= eight;
    return some != 0;
  }
};

/// No score is above this: an arc of nine pixels contains two neighbours of each four that lie at right angles.
template <class P>
RTD_INLINE typename P::Bytes bound(const std::uint8_t* centre, const Circle& circle, std::size_t first) {
  const auto a = P::load(centre + circle[first]), b = P::load(centre + circle[first + 4]),
             c = P::load(centre + circle[first + 8]), d = P::load(centre + circle[first + 12]);
  return P::contrast(P::load(centre), P::lesser(P::greater(a, c), P::greater(b, d)),
                     P::greater(P::lesser(a, c), P::lesser(b, d)));
}

/// The greatest minimum, and the least maximum, of the arcs of nine pixels. The two arcs that share the pixels k to
/// k + 7 are taken together.
template <class P>
RTD_INLINE typename P::Bytes score(const std::uint8_t* centre, const Circle& circle) {
  using Bytes = typename P::Bytes;
  std::array<Bytes, kCircle> pixel, low, high;
  for (std::size_t k = 0; k < kCircle; ++k) pixel[k] = P::load(centre + circle[k]);
  for (std::size_t k = 1; k < kCircle; k += 2) {  // two pixels
    low[k] = P::lesser(pixel[k], pixel[(k + 1) % kCircle]);
    high[k] = P::greater(pixel[k], pixel[(k + 1) % kCircle]);
  }
  std::array<Bytes, kCircle> low_four, high_four;
  for (std::size_t k = 1; k < kCircle; k += 2) {
    low_four[k] = P::lesser(low[k], low[(k + 2) % kCircle]);
    high_four[k] = P::greater(high[k], high[(k + 2) % kCircle]);
  }
  Bytes brighter{}, darker = ~Bytes{};
  for (std::size_t k = 1; k < kCircle; k += 2) {
    const std::size_t before = k - 1, behind = (k + 8) % kCircle, four_on = (k + 4) % kCircle;
    const Bytes low_eight = P::lesser(low_four[k], low_four[four_on]);
    const Bytes high_eight = P::greater(high_four[k], high_four[four_on]);
    brighter = P::greater(brighter, P::lesser(low_eight, P::greater(pixel[before], pixel[behind])));
    darker = P::lesser(darker, P::greater(high_eight, P::lesser(pixel[before], pixel[behind])));
  }
  return P::contrast(P::load(centre), brighter, darker);
}

/// Pixels [begin, end) of a row, not fewer than a block has. Blocks cover it; the last one may overlap the one before.
struct Row {
  const std::uint8_t* from;
  std::uint8_t* to;
  int begin, end;
};

template <class P>
RTD_INLINE void score_block(const Row& row, int x, const Circle& circle, const typename P::Bytes& threshold) {
  const std::uint8_t* centre = row.from + x;
  const auto most = P::above(P::lesser(bound<P>(centre, circle, 0), bound<P>(centre, circle, 2)), threshold);
  P::store(row.to + x, P::any(most) ? P::above(score<P>(centre, circle), threshold) : most);
}

template <class P>
RTD_INLINE void score_row(const Row& row, const Circle& circle, std::uint8_t threshold) {
  const typename P::Bytes all = typename P::Bytes{} + threshold;
  int x = row.begin;
  for (; x + P::kCount <= row.end; x += P::kCount) score_block<P>(row, x, circle, all);
  if (x < row.end) score_block<P>(row, row.end - P::kCount, circle, all);
}

template <class P>
RTD_INLINE void keep_peaks_of_block(const Row& row, int x, std::ptrdiff_t step) {
  const std::uint8_t *middle = row.from + x, *above = middle - step, *below = middle + step;
  auto greatest = P::greater(P::load(middle - 1), P::load(middle + 1));
  for (int i = -1; i <= 1; ++i) greatest = P::greater(greatest, P::greater(P::load(above + i), P::load(below + i)));
  P::store(row.to + x, P::above(P::load(middle), greatest));
}

template <class P>
RTD_INLINE void keep_peaks(const Row& row, std::ptrdiff_t step) {
  int x = row.begin;
  for (; x + P::kCount <= row.end; x += P::kCount) keep_peaks_of_block<P>(row, x, step);
  if (x < row.end) keep_peaks_of_block<P>(row, row.end - P::kCount, step);
}

void score_row_1(const Row& row, const Circle& circle, std::uint8_t threshold) {
  score_row<Pixels<1>>(row, circle, threshold);
}
void score_row_16(const Row& row, const Circle& circle, std::uint8_t threshold) {
  score_row<Pixels<16>>(row, circle, threshold);
}
RTD_AVX2 void score_row_32(const Row& row, const Circle& circle, std::uint8_t threshold) {
  score_row<Pixels<32>>(row, circle, threshold);
}
void keep_peaks_1(const Row& row, std::ptrdiff_t step) {
  keep_peaks<Pixels<1>>(row, step);
}
void keep_peaks_16(const Row& row, std::ptrdiff_t step) {
  keep_peaks<Pixels<16>>(row, step);
}
RTD_AVX2 void keep_peaks_32(const Row& row, std::ptrdiff_t step) {
  keep_peaks<Pixels<32>>(row, step);
}

/// The pixels next to the area.
void clear_around(const cv::Rect& area, cv::Mat& scores) {
  const int left = area.x - 1, top = area.y - 1, right = area.x + area.width, bottom = area.y + area.height;
  for (const int y : {top, bottom}) std::fill_n(scores.ptr(y) + left, area.width + 2, std::uint8_t{0});
  for (int y = area.y; y < bottom; ++y) scores.ptr(y)[left] = scores.ptr(y)[right] = 0;
}

struct Kernels {
  decltype(&score_row_1) score;
  decltype(&keep_peaks_1) keep;
};

Kernels kernels_for(int width) {
  if (width < 16) return {score_row_1, keep_peaks_1};
  if (width < 32 || !vision::wide_vectors()) return {score_row_16, keep_peaks_16};
  return {score_row_32, keep_peaks_32};
}

}  // namespace

cv::Mat fast_scores(const cv::Mat& grey, const cv::Rect& area, int threshold) {
  cv::Mat scores(grey.size(), CV_8UC1);
  clear_around(area, scores);
  const Circle circle = circle_of(grey);
  const Kernels kernels = kernels_for(area.width);
  for (int y = area.y; y < area.y + area.height; ++y)
    kernels.score({grey.ptr(y), scores.ptr(y), area.x, area.x + area.width}, circle,
                  static_cast<std::uint8_t>(threshold));
  return scores;
}

cv::Mat peaks_of(const cv::Mat& scores, const cv::Rect& area) {
  cv::Mat peaks(scores.size(), CV_8UC1);
  const Kernels kernels = kernels_for(area.width);
  for (int y = area.y; y < area.y + area.height; ++y)
    kernels.keep({scores.ptr(y), peaks.ptr(y), area.x, area.x + area.width}, static_cast<std::ptrdiff_t>(scores.step));
  return peaks;
}

}  // namespace rtd::filter
