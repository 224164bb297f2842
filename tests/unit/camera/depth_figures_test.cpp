// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/depth_figures.hpp"

#include <gmock/gmock.h>

#include <cmath>

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

}  // namespace
}  // namespace rtd::camera
