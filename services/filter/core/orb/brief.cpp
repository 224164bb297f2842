// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/brief.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "services/filter/core/orb/corners.hpp"

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

constexpr double kPatternRadiusPx = kPatchRadiusPx - 1;  // rounding after rotation adds less than one pixel
constexpr double kSpreadPx = 6.2;                        // standard deviation, patch / 5 (Calonder et al. 2010, G II)
constexpr double kCorrelationPx = 7.0;                   // distance over which grey values forget each other
constexpr double kMinPairPx = 4.0;                       // shorter pairs compare nearly the same pixel after smoothing

struct Pair {
  int ax, ay, bx, by;
};

/// Gaussian by the sum of twelve uniforms: the same bits with every standard library.
int gaussian_px(std::mt19937_64& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(random() >> 11U) * 0x1.0p-53;
  return static_cast<int>(std::lround(sum * kSpreadPx));
}

bool in_patch(int x, int y) {
  return x * x + y * y <= kPatternRadiusPx * kPatternRadiusPx;
}

/// Autocorrelation of grey values at an offset, Eq. (3).
double grey_correlation(int dx, int dy) {
  return std::exp(-std::sqrt(static_cast<double>(dx * dx + dy * dy)) / kCorrelationPx);
}

/// Expected correlation of two comparisons, Eq. (4).
double pair_correlation(const Pair& p, const Pair& q) {
  const double covariance = grey_correlation(p.ax - q.ax, p.ay - q.ay) - grey_correlation(p.ax - q.bx, p.ay - q.by) -
                            grey_correlation(p.bx - q.ax, p.by - q.ay) + grey_correlation(p.bx - q.bx, p.by - q.by);
  const double variance_p = 2 - 2 * grey_correlation(p.ax - p.bx, p.ay - p.by);
  const double variance_q = 2 - 2 * grey_correlation(q.ax - q.bx, q.ay - q.by);
  return covariance / std::sqrt(variance_p * variance_q);
}

Pair draw_pair(std::mt19937_64& random) {
  for (;;) {
    const Pair pair{gaussian_px(random), gaussian_px(random), gaussian_px(random), gaussian_px(random)};
    const int dx = pair.ax - pair.bx, dy = pair.ay - pair.by;
    if (in_patch(pair.ax, pair.ay) && in_patch(pair.bx, pair.by) && dx * dx + dy * dy >= kMinPairPx * kMinPairPx)
      return pair;
  }
}

std::vector<Pair> choose_pairs() {
  constexpr int kTriesPerLimit = 300;
  std::mt19937_64 random(20260521);
  std::vector<Pair> chosen;
  double limit = 0.2;  // relaxed whenever no candidate passes for a while
  for (int tries = 0; chosen.size() < BriefPattern::kBits; ++tries) {
    if (tries == kTriesPerLimit) {
      limit += 0.02;
      tries = 0;
    }
    const Pair candidate = draw_pair(random);
    bool is_independent = true;
    for (const Pair& taken : chosen)
      is_independent = is_independent && std::abs(pair_correlation(candidate, taken)) < limit;
    if (!is_independent) continue;
    chosen.push_back(candidate);
    tries = 0;
  }
  return chosen;
}

BriefPattern make_pattern() {
  BriefPattern pattern;
  const std::vector<Pair> pairs = choose_pairs();
  for (std::size_t k = 0; k < BriefPattern::kBits; ++k) {
    pattern.x[2 * k] = static_cast<float>(pairs[k].ax);
    pattern.y[2 * k] = static_cast<float>(pairs[k].ay);
    pattern.x[2 * k + 1] = static_cast<float>(pairs[k].bx);
    pattern.y[2 * k + 1] = static_cast<float>(pairs[k].by);
  }
  return pattern;
}

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

const BriefPattern& brief_pattern() {
  static const BriefPattern pattern = make_pattern();
  return pattern;
}

msg::Descriptor rotated_brief(const cv::Mat& smoothed, cv::Point centre, float angle_rad) {
  const BriefPattern& pattern = brief_pattern();
  const float cosine = std::cos(angle_rad), sine = std::sin(angle_rad);
  const int stride = static_cast<int>(smoothed.step);
  constexpr float kBias = 64.5F;  // makes truncation round to nearest, also below zero
  std::array<int, 2 * BriefPattern::kBits> offsets;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const int dx = static_cast<int>(pattern.x[i] * cosine - pattern.y[i] * sine + kBias) - 64;
    const int dy = static_cast<int>(pattern.x[i] * sine + pattern.y[i] * cosine + kBias) - 64;
    offsets[i] = dy * stride + dx;
  }
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
