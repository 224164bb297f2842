// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <random>
#include <vector>

#include "services/filter/core/orb/corners.hpp"
#include "services/filter/core/orb/fast_scores.hpp"
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

/// Whatever OpenCV finds, with its score, and nothing else.
void expect_scores_of_opencv(const cv::Mat& grey, int threshold) {
  const cv::Rect area(kFastRadiusPx, kFastRadiusPx, grey.cols - 2 * kFastRadiusPx, grey.rows - 2 * kFastRadiusPx);
  std::vector<cv::KeyPoint> found;
  cv::FAST(grey, found, threshold, false);
  const cv::Mat scores = fast_scores(grey, area, threshold);
  EXPECT_EQ(cv::countNonZero(scores(area)), static_cast<int>(found.size())) << grey.cols << " px wide";
  for (const cv::KeyPoint& corner : found)
    EXPECT_GT(scores.at<std::uint8_t>(corner.pt), threshold) << corner.pt << ", " << grey.cols << " px wide";
  cv::FAST(grey, found, threshold, true);  // only peaks have a score there
  for (const cv::KeyPoint& corner : found)
    EXPECT_EQ(scores.at<std::uint8_t>(corner.pt), corner.response + 1) << corner.pt << ", " << grey.cols << " px wide";
}

TEST(FastScores, are_those_of_opencv_in_textured_images_of_any_width) {
  for (const int width : {8, 21, 22, 23, 37, 38, 39, 100, 321}) {
    const cv::Mat image = test::textured_image({width, 60});
    for (const int threshold : {1, 7, 20, 60}) expect_scores_of_opencv(image, threshold);
  }
}

TEST(FastScores, are_those_of_opencv_in_noise_of_full_contrast) {
  cv::Mat noise(90, 130, CV_8UC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0, 256);
  for (const int threshold : {1, 20, 254}) expect_scores_of_opencv(noise, threshold);
  expect_scores_of_opencv(noise > 128, 255);  // only black and white
}

TEST(FastScores, are_zero_next_to_the_area) {
  const cv::Mat image = test::textured_image({200, 150});
  const cv::Rect area(40, 50, 100, 60), with_neighbours(39, 49, 102, 62);
  cv::Mat scores = fast_scores(image, area, 5);
  EXPECT_GT(cv::countNonZero(scores(area)), 100);
  scores(area) = 0;
  EXPECT_EQ(cv::countNonZero(scores(with_neighbours)), 0);
}

TEST(FastScores, of_peaks_are_above_those_of_all_neighbours) {
  const cv::Mat image = test::textured_image({200, 150});
  for (const int width : {5, 20, 190}) {
    const cv::Rect area(5, 7, width, 130);
    const cv::Mat scores = fast_scores(image, area, 10), peaks = peaks_of(scores, area);
    int count = 0;
    for (int y = area.y; y < area.y + area.height; ++y) {
      for (int x = area.x; x < area.x + area.width; ++x) {
        const int score = scores.at<std::uint8_t>(y, x);
        bool is_peak = score > 0;
        for (int i = 0; i < 9; ++i)
          is_peak = is_peak && (i == 4 || scores.at<std::uint8_t>(y - 1 + i / 3, x - 1 + i % 3) < score);
        EXPECT_EQ(peaks.at<std::uint8_t>(y, x), is_peak ? score : 0) << x << ", " << y;
        count += is_peak ? 1 : 0;
      }
    }
    EXPECT_EQ(cv::countNonZero(peaks(area)), count);
  }
}

/// The corners of cv::FAST with non-maximum suppression inside `area`.
void append_corners_of_opencv(const cv::Mat& grey, const cv::Rect& area, int threshold, std::vector<Corner>& corners) {
  const cv::Point corner(area.x - kFastRadiusPx, area.y - kFastRadiusPx);
  std::vector<cv::KeyPoint> found;
  cv::FAST(grey(cv::Rect(corner, area.size() + cv::Size(2 * kFastRadiusPx, 2 * kFastRadiusPx))), found, threshold,
           true);
  for (const cv::KeyPoint& point : found)
    corners.push_back(
        {point.pt.x + static_cast<float>(corner.x), point.pt.y + static_cast<float>(corner.y), point.response});
}

TEST(CornerDetector, finds_the_corners_of_opencv_everywhere_then_in_cells_without_any) {
  cv::Mat image = test::textured_image({320, 64});
  cv::Mat faint = image.colRange(100, 320);
  faint = faint / 8 + 100;
  OrbConfig config;
  config.cell_px = 32;  // one row of nine cells, of 32 x 32 px
  std::vector<Corner> wanted;
  append_corners_of_opencv(image, cv::Rect(kBorderPx, kBorderPx, 288, 32), config.fast_threshold, wanted);
  ASSERT_FALSE(wanted.empty());
  const auto farthest = std::max_element(wanted.begin(), wanted.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const int first_free = static_cast<int>(farthest->x - kBorderPx) / 32 + 1;
  ASSERT_LT(first_free, 6) << "cells without a corner remain";
  append_corners_of_opencv(image, cv::Rect(kBorderPx + 32 * first_free, kBorderPx, 288 - 32 * first_free, 32),
                           config.fast_threshold_low, wanted);
  const std::vector<Corner> found = detect_corners(image, config);
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].x, wanted[i].x) << i;
    EXPECT_EQ(found[i].y, wanted[i].y) << i;
    EXPECT_EQ(found[i].response, wanted[i].response) << i;
  }
}

}  // namespace
}  // namespace rtd::filter
