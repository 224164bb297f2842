// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/corners.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

TEST(CornerDetector, keeps_the_patch_inside_the_image) {
  const cv::Mat image = test::textured_image({200, 150});
  const std::vector<Corner> corners = detect_corners(image, OrbConfig{});
  EXPECT_GT(corners.size(), 50U);
  for (const Corner& corner : corners) {
    EXPECT_GE(std::min(corner.x, corner.y), kBorderPx);
    EXPECT_LT(corner.x, 200 - kBorderPx);
    EXPECT_LT(corner.y, 150 - kBorderPx);
  }
}

TEST(CornerDetector, finds_faint_corners_where_there_are_no_others) {
  cv::Mat image(300, 300, CV_8UC1, cv::Scalar(100));
  cv::rectangle(image, cv::Rect(60, 60, 12, 12), cv::Scalar(200), cv::FILLED);    // contrast 100
  cv::rectangle(image, cv::Rect(220, 220, 12, 12), cv::Scalar(115), cv::FILLED);  // contrast 15: low threshold only
  cv::GaussianBlur(image, image, cv::Size(5, 5), 1);  // equal neighbours would suppress each other
  const std::vector<Corner> corners = detect_corners(image, OrbConfig{});
  EXPECT_TRUE(std::any_of(corners.begin(), corners.end(), [](const Corner& c) { return c.x < 100; }));
  EXPECT_TRUE(std::any_of(corners.begin(), corners.end(), [](const Corner& c) { return c.x > 200; }));
}

TEST(CornerDetector, finds_nothing_in_an_image_smaller_than_a_patch) {
  EXPECT_TRUE(detect_corners(test::textured_image({30, 30}), OrbConfig{}).empty());
}

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
