// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "common/camera/depth_figures.hpp"
#include "services/camera/core/depth_colors.hpp"

namespace rtd::camera {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kTum_m = 1.0 / 5000, kMillimetre_m = 0.001;

/// A floor that goes away from the camera, with a quarter of holes above it.
cv::Mat room(double near_units, double far_units) {
  cv::Mat depth(240, 320, CV_16UC1, cv::Scalar(0));
  for (int row = 60; row < depth.rows; ++row)
    depth.row(row).setTo(cv::Scalar(far_units + (near_units - far_units) * (row - 60) / 180));
  return depth;
}

std::string doubt(const cv::Mat& depth, double scale_m, bool given) {
  DepthFigures figures;
  figures.add(depth, scale_m);
  return figures.doubt(given);
}

TEST(DepthFigures, measure_median_quantiles_and_holes) {
  DepthFigures figures;
  EXPECT_FALSE(figures.median_m());
  EXPECT_EQ(figures.hole_share(), 0);
  figures.add(room(1000, 3000), kMillimetre_m);
  EXPECT_NEAR(*figures.median_m(), 2.0, 0.06);
  EXPECT_NEAR(*figures.quantile_m(0.9), 2.8, 0.08);
  EXPECT_NEAR(figures.hole_share(), 0.25, 0.02);
}

TEST(DepthFigures, take_every_value_of_16_bits) {
  DepthFigures figures;
  for (const int value : {1, 2, 65534, 65535}) figures.add(cv::Mat(64, 64, CV_16UC1, cv::Scalar(value)), kMillimetre_m);
  EXPECT_NEAR(*figures.quantile_m(1), 65.5, 1);
}

TEST(DepthFigures, millimetres_that_are_read_as_tum_units_are_doubted_even_if_given) {
  for (const bool given : {false, true}) {
    EXPECT_THAT(doubt(room(700, 2400), kTum_m, given),
                AllOf(HasSubstr("millimetres"), HasSubstr("?depth_factor=1000")));
  }
}

TEST(DepthFigures, tum_units_that_are_read_as_millimetres_are_doubted) {
  EXPECT_THAT(doubt(room(5000, 20000), kMillimetre_m, false), HasSubstr("?depth_factor=5000"));
  EXPECT_THAT(doubt(room(15000, 30000), kMillimetre_m, true), AllOf(HasSubstr("between"), HasSubstr("5000")));
}

TEST(DepthFigures, metres_and_tenths_of_millimetres_are_doubted) {
  EXPECT_THAT(doubt(room(1, 3), kTum_m, false), AllOf(HasSubstr("likely metres"), HasSubstr("?depth_factor=1")));
  EXPECT_THAT(doubt(room(30000, 60000), kMillimetre_m, false), HasSubstr("depth_factor=10000"));
}

TEST(DepthFigures, usual_rooms_desks_and_halls_are_not_doubted) {
  EXPECT_EQ(doubt(room(3500, 20000), kTum_m, false), "") << "0.7 to 4 m";
  EXPECT_EQ(doubt(room(1000, 9000), kMillimetre_m, false), "");
  EXPECT_EQ(doubt(room(400, 900), kMillimetre_m, true), "") << "a desk";
  EXPECT_EQ(doubt(room(4000, 9500), kMillimetre_m, true), "") << "a hall";
  EXPECT_EQ(doubt(cv::Mat(240, 320, CV_16UC1, cv::Scalar(0)), kTum_m, false), "") << "nothing measured";
}

TEST(DepthFigures, floats_beyond_a_hundred_are_millimetres) {
  cv::Mat metres(48, 64, CV_32FC1, cv::Scalar(2.5F)), sky = metres.clone();
  sky.rowRange(0, 40).setTo(10000);
  EXPECT_FALSE(floats_are_millimetres(metres));
  EXPECT_FALSE(floats_are_millimetres(sky)) << "a renderer's sky above a near floor";
  EXPECT_TRUE(floats_are_millimetres(metres * 1000));
  EXPECT_FALSE(floats_are_millimetres(cv::Mat(48, 64, CV_32FC1, cv::Scalar(NAN))));
}

TEST(DepthFigures, of_rotated_bits_advise_no_unit) {
  cv::Mat rotated = room(900, 3000) * 8;
  const std::string doubted = doubt(rotated, kMillimetre_m, false);
  EXPECT_THAT(doubted, AllOf(HasSubstr("SUN3D"), testing::Not(HasSubstr("depth_factor=5000"))));
  EXPECT_TRUE(is_rotated(rotated));
  rotate_back(rotated);
  EXPECT_EQ(cv::countNonZero(rotated != room(900, 3000)), 0);
  EXPECT_FALSE(is_rotated(rotated));
  EXPECT_FALSE(is_rotated(room(5000, 20000))) << "TUM's units";
  EXPECT_FALSE(is_rotated(cv::Mat(240, 320, CV_16UC1, cv::Scalar(16000)))) << "one value says nothing";
}

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
