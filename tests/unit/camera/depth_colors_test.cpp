// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/depth_colors.hpp"

#include <gtest/gtest.h>

namespace rtd::camera {
namespace {

cv::Vec3b color_at(double depth_m, double scale_m = 0.001) {
  return depth_preview(cv::Mat(4, 4, CV_16UC1, cv::Scalar(depth_m / scale_m)), scale_m).at<cv::Vec3b>(1, 1);
}

TEST(DepthColorsTest, near_is_red_far_is_blue_and_nothing_is_black) {
  const cv::Vec3b near = color_at(0.5), far = color_at(5.9), none = color_at(0);
  EXPECT_GT(near[2], 100);
  EXPECT_LT(near[0], 20);
  EXPECT_GT(far[0], 100);
  EXPECT_LT(far[2], 20);
  EXPECT_EQ(none, cv::Vec3b(0, 0, 0));
}

TEST(DepthColorsTest, a_color_means_the_same_in_every_unit_and_image) {
  EXPECT_EQ(color_at(2.5, 0.001), color_at(2.5, 0.0002));
  cv::Mat beside_others(4, 4, CV_16UC1, cv::Scalar(9000));
  beside_others.at<std::uint16_t>(1, 1) = 2500;
  EXPECT_EQ(depth_preview(beside_others, 0.001).at<cv::Vec3b>(1, 1), color_at(2.5));
  EXPECT_EQ(color_at(9), color_at(kPreviewFar_m)) << "beyond the range: the colour of its end";
}

TEST(DepthColorsTest, is_small_and_keeps_holes_as_holes) {
  cv::Mat depth(480, 640, CV_16UC1, cv::Scalar(2000));
  depth.colRange(0, 320) = 0;
  const cv::Mat picture = depth_preview(depth, 0.001);
  EXPECT_EQ(picture.size(), cv::Size(320, 240));
  for (int x = 0; x < picture.cols; ++x)
    EXPECT_EQ(picture.at<cv::Vec3b>(100, x) == cv::Vec3b(0, 0, 0), x < 160) << "no colour between a hole and a surface";
  EXPECT_EQ(depth_preview(cv::Mat(1200, 1920, CV_16UC1, cv::Scalar(1)), 0.001).size(), cv::Size(320, 200));
  EXPECT_TRUE(depth_preview({}, 0.001).empty());
  EXPECT_TRUE(depth_preview(depth, 0).empty()) << "of no unit";
}

}  // namespace
}  // namespace rtd::camera
