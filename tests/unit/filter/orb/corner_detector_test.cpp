// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/corners.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rtd::filter
