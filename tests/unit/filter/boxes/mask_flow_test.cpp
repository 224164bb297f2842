// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/object_tracker.hpp"

#include <gtest/gtest.h>

#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

const Box kMaskBox{{320, 240}, {200, 160}};

/// A texture scaled about the image's centre and shifted.
cv::Mat picture(double shift_x_px, double scale = 1) {
  static const cv::Mat texture = test::textured_image();
  const cv::Mat affine =
      (cv::Mat_<double>(2, 3) << scale, 0, 320 * (1 - scale) + shift_x_px, 0, scale, 240 * (1 - scale));
  cv::Mat moved, color;
  cv::warpAffine(texture, moved, affine, texture.size());
  cv::cvtColor(moved, color, cv::COLOR_GRAY2BGR);
  return color;
}
std::vector<cv::Point2f> points_in_box() {
  std::vector<cv::Point2f> points;
  for (int y = 180; y <= 300; y += 30) {
    for (int x = 240; x <= 400; x += 40) points.emplace_back(static_cast<float>(x), static_cast<float>(y));
  }
  return points;
}

TEST(MaskFlow, finds_the_shift_of_a_box) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, picture(13));
  const auto motion = flow.follow(1, 2, kMaskBox, points_in_box());
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->flow.shift_px.x(), 13, 0.5) << "px";
  EXPECT_NEAR(motion->flow.shift_px.y(), 0, 0.5) << "px";
  EXPECT_NEAR(motion->flow.scale, 1, 0.01);
}

TEST(MaskFlow, finds_the_scale_of_an_approaching_box) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, picture(0, 1.06));
  const auto motion = flow.follow(1, 2, kMaskBox, points_in_box());
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->flow.scale, 1.06, 0.015);
  EXPECT_NEAR(motion->flow.shift_px.norm(), 0, 1.0) << "px";
}

TEST(MaskFlow, returns_nothing_where_no_point_is_found_again) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(128)));
  EXPECT_FALSE(flow.follow(1, 2, kMaskBox, points_in_box()));
}

TEST(MaskFlow, takes_images_that_are_one_pixel_wide_or_high) {
  for (const cv::Size size : {cv::Size(1, 1), {1, 480}, {640, 1}, {3, 1}}) {
    MaskFlow flow;
    flow.see(1, cv::Mat(size, CV_8UC3, cv::Scalar::all(90)));
    flow.see(2, cv::Mat(size, CV_8UC3, cv::Scalar::all(100)));
    EXPECT_NO_THROW(flow.follow(1, 2, kMaskBox, points_in_box())) << size;
  }
}

TEST(MaskFlow, returns_nothing_for_unknown_images_and_too_few_points) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, picture(1));
  EXPECT_FALSE(flow.follow(0, 2, kMaskBox, points_in_box()));
  EXPECT_FALSE(flow.follow(1, 3, kMaskBox, points_in_box()));
  EXPECT_FALSE(flow.follow(1, 2, kMaskBox, {{300, 200}, {310, 210}}));
  EXPECT_FALSE(flow.follow(1, 2, kMaskBox, {}));
}

TEST(MaskFlow, remembers_a_bounded_number_of_images) {
  MaskFlow flow;
  const cv::Mat image = picture(0);
  for (std::int64_t i = 0; i < 40; ++i) flow.see(i, image);
  EXPECT_FALSE(flow.follow(2, 3, kMaskBox, points_in_box()));
  EXPECT_TRUE(flow.follow(38, 39, kMaskBox, points_in_box()));
  flow.see(5, image);
  EXPECT_FALSE(flow.follow(38, 39, kMaskBox, points_in_box())) << "time went back";
}

TEST(MotionOfPoints, is_not_misled_by_a_third_of_wrong_points) {
  const std::vector<cv::Point2f> from = points_in_box();
  std::vector<cv::Point2f> to;
  for (std::size_t i = 0; i < from.size(); ++i) {
    to.push_back(from[i] + (i % 3 == 0 ? cv::Point2f(0, 0) : cv::Point2f(8, -3)));
  }
  const auto flow = motion_of_points(kMaskBox, from, to);
  ASSERT_TRUE(flow);
  EXPECT_NEAR(flow->shift_px.x(), 8, 0.6) << "px";
  EXPECT_NEAR(flow->shift_px.y(), -3, 0.6) << "px";
}

}  // namespace
}  // namespace rtd::filter
