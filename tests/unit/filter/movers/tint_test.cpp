// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/movers/object_sighting.hpp"

#include <gtest/gtest.h>

#include <set>

namespace rtd::filter {
namespace {

ColorHistogram shares_of(const std::vector<cv::Vec3b>& colors_bgr) {
  ColorHistogram shares = ColorHistogram::Zero();
  for (const cv::Vec3b& color : colors_bgr) shares[tint_of(color)] += 1.0 / static_cast<double>(colors_bgr.size());
  return shares;
}

TEST(Tint, keeps_every_color_within_its_classes) {
  std::set<int> tints;
  for (int b = 0; b <= 255; b += 15) {
    for (int g = 0; g <= 255; g += 15) {
      for (int r = 0; r <= 255; r += 15) tints.insert(tint_of(cv::Vec3b(b, g, r)));
    }
  }
  EXPECT_EQ(tints.size(), static_cast<std::size_t>(kTints)) << "each occurs";
  EXPECT_EQ(*tints.begin(), 0);
  EXPECT_EQ(*tints.rbegin(), kTints - 1);
}

TEST(Tint, is_the_same_in_shade_where_there_is_hue) {
  EXPECT_EQ(tint_of({40, 40, 200}), tint_of({24, 24, 120}));
  EXPECT_NE(tint_of({40, 40, 200}), tint_of({200, 40, 40}));
  EXPECT_NE(tint_of({20, 20, 20}), tint_of({230, 230, 230})) << "greys differ by brightness only";
}

TEST(Tint, distinguishes_surfaces_and_reports_nothing_about_unknown_ones) {
  const ColorHistogram red_and_dark = shares_of({{40, 40, 200}, {40, 40, 200}, {20, 20, 20}});
  const ColorHistogram mostly_red = shares_of({{40, 40, 200}, {40, 40, 200}, {40, 40, 200}, {20, 20, 20}});
  const ColorHistogram blue = shares_of({{200, 40, 40}});
  EXPECT_NEAR(histogram_distance(red_and_dark, red_and_dark), 0, 1e-12);
  EXPECT_LT(histogram_distance(red_and_dark, mostly_red), 0.05);
  EXPECT_NEAR(histogram_distance(red_and_dark, blue), 1, 1e-12);
  EXPECT_EQ(histogram_distance(red_and_dark, ColorHistogram::Zero()), 0);
}

}  // namespace
}  // namespace rtd::filter
