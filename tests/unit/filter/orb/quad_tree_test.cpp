// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/corners.hpp"

#include <gmock/gmock.h>

#include <random>

namespace rtd::filter {
namespace {

const cv::Rect kArea(0, 0, 640, 480);

std::vector<Corner> random_corners(int count, float left, float right) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> x(left, right), y(0, 480), response(1, 100);
  std::vector<Corner> corners;
  for (int i = 0; i < count; ++i) corners.push_back({x(random), y(random), response(random)});
  return corners;
}

TEST(QuadTree, gives_the_wanted_number) {
  const std::vector<Corner> spread = spread_corners(random_corners(5000, 0, 640), kArea, 500);
  EXPECT_GE(spread.size(), 500U);
  EXPECT_LE(spread.size(), 502U);
}

TEST(QuadTree, keeps_corners_in_a_sparse_region_beside_a_crowded_one) {
  std::vector<Corner> corners = random_corners(5000, 0, 160);
  const std::vector<Corner> sparse = random_corners(60, 320, 640);
  corners.insert(corners.end(), sparse.begin(), sparse.end());
  const std::vector<Corner> spread = spread_corners(corners, kArea, 200);
  const auto on_the_right = std::count_if(spread.begin(), spread.end(), [](const Corner& c) { return c.x >= 320; });
  EXPECT_GE(on_the_right, 45) << "of 60 corners in the sparse half";
}

TEST(QuadTree, keeps_the_strongest_corner_of_a_cell) {
  const std::vector<Corner> spread = spread_corners({{10, 10, 5}, {11, 11, 50}, {12, 10, 7}}, kArea, 1);
  ASSERT_EQ(spread.size(), 1U);
  EXPECT_EQ(spread[0].response, 50);
}

TEST(QuadTree, terminates_with_corners_on_one_spot) {
  const std::vector<Corner> same(100, Corner{100, 100, 10});
  EXPECT_EQ(spread_corners(same, kArea, 50).size(), 1U);
}

TEST(QuadTree, returns_nothing_for_no_corners) {
  EXPECT_TRUE(spread_corners({}, kArea, 100).empty());
  EXPECT_TRUE(spread_corners(random_corners(10, 0, 640), kArea, 0).empty());
}

}  // namespace
}  // namespace rtd::filter
