// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>
#include <vector>

#include "common/vision/features.hpp"
#include "services/filter/core/orb/brief.hpp"
#include "services/filter/core/orb/corners.hpp"
#include "services/filter/core/orb/shrink.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

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

TEST(BriefPattern, is_what_its_rule_chooses) {
  const BriefPattern& pattern = brief_pattern();
  const std::vector<Pair> pairs = choose_pairs();
  for (std::size_t k = 0; k < BriefPattern::kBits; ++k) {
    EXPECT_EQ(pattern.x[2 * k], pairs[k].ax) << "pair " << k;
    EXPECT_EQ(pattern.y[2 * k], pairs[k].ay) << "pair " << k;
    EXPECT_EQ(pattern.x[2 * k + 1], pairs[k].bx) << "pair " << k;
    EXPECT_EQ(pattern.y[2 * k + 1], pairs[k].by) << "pair " << k;
  }
}

TEST(BriefPattern, stays_inside_the_patch_when_rotated) {
  const BriefPattern& pattern = brief_pattern();
  for (std::size_t i = 0; i < pattern.x.size(); ++i) {
    EXPECT_LE(std::hypot(pattern.x[i], pattern.y[i]), kPatchRadiusPx - 1) << "point " << i;
  }
}

TEST(BriefPattern, has_no_duplicate_comparison) {
  const BriefPattern& pattern = brief_pattern();
  std::set<std::array<float, 4>> seen;
  for (std::size_t k = 0; k < BriefPattern::kBits; ++k) {
    const std::array<float, 4> pair{pattern.x[2 * k], pattern.y[2 * k], pattern.x[2 * k + 1], pattern.y[2 * k + 1]};
    EXPECT_TRUE(seen.insert(pair).second);
    EXPECT_TRUE(seen.insert({pair[2], pair[3], pair[0], pair[1]}).second);
  }
}

TEST(RotatedBrief, differs_in_half_of_the_bits_between_unlike_patches) {
  const cv::Mat image = test::textured_image();
  double sum = 0;
  int count = 0;
  for (int x = 40; x < 600; x += 40) {
    for (int y = 40; y < 400; y += 40, ++count) {
      sum += vision::hamming_distance(rotated_brief(image, {x, y}, 0), rotated_brief(image, {x + 20, y + 37}, 0));
    }
  }
  EXPECT_NEAR(sum / count, 128, 12) << "mean bits";
}

TEST(RotatedBrief, rotated_by_the_angle_matches_a_rotated_patch) {
  cv::Mat image = test::textured_image({121, 121});
  cv::GaussianBlur(image, image, cv::Size(7, 7), 2);
  const msg::Descriptor upright = rotated_brief(image, {60, 60}, 0);
  for (const double degrees : {30.0, 90.0, 145.0, 180.0, -75.0}) {
    cv::Mat turned;
    cv::warpAffine(image, turned, cv::getRotationMatrix2D({60, 60}, -degrees, 1), image.size());
    const auto angle = static_cast<float>(degrees * CV_PI / 180);
    EXPECT_LE(vision::hamming_distance(upright, rotated_brief(turned, {60, 60}, angle)), 25) << degrees << " degrees";
  }
}

TEST(Orientation, points_to_the_bright_side) {
  for (double angle = -3.0; angle < 3.1; angle += 0.25) {
    cv::Mat ramp(61, 61, CV_8UC1);
    for (int y = 0; y < ramp.rows; ++y) {
      for (int x = 0; x < ramp.cols; ++x) {
        ramp.at<std::uint8_t>(y, x) =
            cv::saturate_cast<std::uint8_t>(128 + 4 * ((x - 30) * std::cos(angle) + (y - 30) * std::sin(angle)));
      }
    }
    EXPECT_NEAR(centroid_angle_rad(ramp, {30, 30}), angle, 0.02) << "rad";
  }
}

TEST(Orientation, is_that_of_the_sums_over_the_disc) {
  cv::Mat noise(80, 90, CV_8UC1);
  cv::theRNG().state = 5;
  cv::randu(noise, 0, 256);
  for (const cv::Point centre : {cv::Point(16, 16), cv::Point(73, 63), cv::Point(40, 30)}) {
    int m10 = 0, m01 = 0;
    for (int v = -kPatchRadiusPx; v <= kPatchRadiusPx; ++v) {
      for (int u = -kPatchRadiusPx; u <= kPatchRadiusPx; ++u) {
        if (u * u + v * v > kPatchRadiusPx * (kPatchRadiusPx + 1)) continue;
        const int grey = noise.at<std::uint8_t>(centre + cv::Point(u, v));
        m10 += u * grey;
        m01 += v * grey;
      }
    }
    EXPECT_EQ(centroid_angle_rad(noise, centre), std::atan2(static_cast<float>(m01), static_cast<float>(m10)));
  }
}

TEST(Orientation, of_a_flat_patch_is_zero) {
  EXPECT_EQ(centroid_angle_rad(cv::Mat(61, 61, CV_8UC1, cv::Scalar(90)), {30, 30}), 0.0F);
}

TEST(Shrink, gives_the_pixels_of_opencv) {
  cv::theRNG().state = 11;
  for (const cv::Size size :
       {cv::Size(640, 480), cv::Size(333, 61), cv::Size(40, 40), cv::Size(17, 9), cv::Size(5, 5)}) {
    cv::Mat image(size, CV_8UC1), expected, found;
    cv::randu(image, 0, 256);
    for (const double scale : {1.01, 1.05, 1.2, 1.3, 1.5, 1.79, 1.8, 2.0, 2.5, 0.9}) {
      const cv::Size smaller(static_cast<int>(std::lround(size.width / scale)),
                             static_cast<int>(std::lround(size.height / scale)));
      cv::resize(image, expected, smaller, 0, 0, cv::INTER_LINEAR);
      shrink(image, smaller, found);
      ASSERT_EQ(found.size(), smaller);
      EXPECT_EQ(cv::norm(expected, found, cv::NORM_INF), 0) << size << " by " << scale;
    }
  }
}

TEST(Smoothing, gives_the_pixels_of_opencv) {
  cv::theRNG().state = 3;
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(77, 45), cv::Size(7, 7), cv::Size(4, 90)}) {
    cv::Mat grey(size, CV_8UC1), expected, smoothed;
    cv::randu(grey, 0, 256);
    cv::GaussianBlur(grey, expected, cv::Size(7, 7), 2, 2, cv::BORDER_REFLECT_101);
    smooth(grey, smoothed);
    EXPECT_EQ(cv::norm(expected, smoothed, cv::NORM_INF), 0) << size;
  }
}

TEST(Smoothing, keeps_black_and_white) {
  cv::Mat smoothed;
  for (const int grey : {0, 255}) {
    smooth(cv::Mat(50, 60, CV_8UC1, cv::Scalar(grey)), smoothed);
    EXPECT_EQ(cv::countNonZero(smoothed != grey), 0);
  }
}

}  // namespace
}  // namespace rtd::filter
