// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/depth_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/camera/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr int kWidth = 240, kHeight = 160;
constexpr float kUnitsPerM = 5000;
const cv::Range kBox(100, 150);  ///< columns of the near object

DepthScene wall_at(float depth_m) {
  return {cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(1.0F / depth_m)),
          cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(static_cast<int>(Material::kPlain))),
          cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(128))};
}

/// A wall at 4 m and an object before it over the whole height.
DepthScene object_at(float depth_m) {
  DepthScene view = wall_at(4);
  view.inverse_depth.colRange(kBox).setTo(1.0F / depth_m);
  return view;
}

cv::Mat measure(const SensorFaults& faults, const DepthScene& view, const SensorModel& model = {}) {
  return DepthFaults(faults, model, {kWidth, kHeight}, 1).measure(view, 3);
}

double hole_share(const cv::Mat& depth) {
  return 1 - cv::countNonZero(depth) / static_cast<double>(depth.total());
}

float metres(const cv::Mat& depth, int row, int column) {
  return static_cast<float>(depth.at<std::uint16_t>(row, column)) / kUnitsPerM;
}

int count_between(const cv::Mat& depth, double from_m, double to_m) {
  cv::Mat inside;
  cv::inRange(depth, from_m * static_cast<double>(kUnitsPerM), to_m * static_cast<double>(kUnitsPerM), inside);
  return cv::countNonZero(inside);
}

/// Mean column of the pixels that are nearer than 3 m.
double middle_of_near(const cv::Mat& depth) {
  double sum = 0, count = 0;
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      if (metres(depth, row, column) > 0 && metres(depth, row, column) < 3) {
        sum += column;
        ++count;
      }
    }
  }
  return sum / count;
}

TEST(DepthFaults, none_leave_the_sensors_own_bits) {
  const DepthScene view = object_at(2);
  const cv::Mat plain = Sensor({}, 1).measure_depth(view.inverse_depth, 3);
  EXPECT_EQ(cv::norm(measure({}, view), plain, cv::NORM_L1), 0);
}

TEST(DepthFaults, disparity_has_steps) {
  for (const double step_px : {0.125, 0.5}) {
    SensorModel model;
    model.disparity_step_px = static_cast<float>(step_px);
    const cv::Mat depth = measure({}, wall_at(2.1F), model);
    for (int column = 0; column < kWidth; ++column) {
      const double steps = 43.5 / static_cast<double>(metres(depth, 20, column)) / step_px;
      EXPECT_NEAR(steps, std::round(steps), 0.02);
    }
  }
}

/// Correlation of the disparity with itself so many pixels to the right and below.
double correlation(const cv::Mat& depth, int distance_px) {
  cv::Mat disparity(depth.size(), CV_64FC1);
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      disparity.at<double>(row, column) = 1.0 / static_cast<double>(metres(depth, row, column));
    }
  }
  disparity -= cv::mean(disparity)[0];
  const cv::Size part(depth.cols - distance_px, depth.rows - distance_px);
  const cv::Mat here = disparity(cv::Rect({0, 0}, part));
  const double right = here.dot(disparity(cv::Rect({distance_px, 0}, part)));
  const double below = here.dot(disparity(cv::Rect({0, distance_px}, part)));
  return (right + below) / 2 / here.dot(here);
}

TEST(DepthFaults, noise_is_correlated_over_five_pixels) {
  SensorModel model;
  model.disparity_noise_steps = 2;  // large against the rounding
  SensorFaults faults;
  EXPECT_LT(std::abs(correlation(measure(faults, wall_at(3), model), 1)), 0.1);
  faults.noise_correlation_px = 5;
  const cv::Mat depth = measure(faults, wall_at(3), model);
  EXPECT_GT(correlation(depth, 1), 0.85);
  EXPECT_NEAR(correlation(depth, 5), std::exp(-1), 0.12);
  EXPECT_LT(std::abs(correlation(depth, 15)), 0.15);
}

TEST(DepthFaults, holes_have_the_wanted_share_and_come_in_blobs) {
  SensorFaults faults;
  for (const double share : {0.15, 0.3}) {
    faults.holes = share;
    const cv::Mat depth = measure(faults, object_at(2));
    EXPECT_NEAR(hole_share(depth), share, 0.005);
  }
  cv::Mat holes = measure(faults, wall_at(3)) == 0;
  int alike = 0;
  for (int column = 1; column < kWidth; ++column) {
    alike += holes.at<std::uint8_t>(50, column) == holes.at<std::uint8_t>(50, column - 1) ? 1 : 0;
  }
  EXPECT_GT(alike, kWidth * 4 / 5) << "single pixels would agree with their neighbours in 58 %";
}

TEST(DepthFaults, dark_surfaces_and_monitors_lose_most_of_their_depth) {
  DepthScene view = wall_at(2);
  view.material.colRange(0, 60).setTo(static_cast<int>(Material::kDark));
  view.color_bgr.colRange(60, 120).setTo(cv::Scalar::all(20));
  view.material.colRange(120, 180).setTo(static_cast<int>(Material::kMonitor));
  SensorFaults faults;
  faults.dark_holes = 0.75;
  faults.monitor_holes = 0.9;
  const cv::Mat depth = measure(faults, view);
  EXPECT_NEAR(hole_share(depth.colRange(0, 60)), 0.75, 0.08);
  EXPECT_NEAR(hole_share(depth.colRange(60, 120)), 0.75, 0.08) << "dark paint";
  EXPECT_NEAR(hole_share(depth.colRange(120, 180)), 0.9, 0.06);
  EXPECT_EQ(hole_share(depth.colRange(180, kWidth)), 0);
}

TEST(DepthFaults, flying_pixels_lie_between_the_surfaces_of_an_edge) {
  EXPECT_EQ(count_between(measure({}, object_at(2)), 2.2, 3.7), 0);
  for (const int width_px : {2, 4}) {
    SensorFaults faults;
    faults.flying_px = width_px;
    const cv::Mat depth = measure(faults, object_at(2));
    const double per_edge = count_between(depth, 2.1, 3.85) / 2.0 / kHeight;
    EXPECT_GT(per_edge, 0.4 * width_px);
    EXPECT_LE(per_edge, width_px);
    EXPECT_EQ(count_between(depth.colRange(110, 140), 2.2, 3.7), 0) << "away from edges";
  }
}

TEST(DepthFaults, values_lie_on_the_wrong_side_of_an_edge) {
  const auto beyond = [](const cv::Mat& depth) { return count_between(depth.colRange(kBox.end, kWidth), 1, 2.2); };
  EXPECT_EQ(beyond(measure({}, object_at(2))), 0);
  SensorFaults faults;
  faults.wrong_side_px = 3;
  const cv::Mat depth = measure(faults, object_at(2));
  EXPECT_GT(beyond(depth), kHeight / 10);
  EXPECT_EQ(count_between(depth.colRange(kBox.end + 3, kWidth), 1, 2.2), 0) << "at most 3 px";
}

TEST(DepthFaults, shadow_lies_left_of_an_object_and_is_as_wide_as_wanted) {
  for (const double shadow_px : {8.0, 14.0, 20.0}) {
    SensorModel model;
    model.shadow_px_m = static_cast<float>(4 * shadow_px);
    const cv::Mat depth = measure({}, object_at(2), model);
    EXPECT_NEAR(kBox.start - cv::countNonZero(depth.row(50).colRange(0, kBox.start)), shadow_px, 2);
    EXPECT_EQ(cv::countNonZero(depth.row(50).colRange(kBox.end + 2, kWidth)), kWidth - kBox.end - 2);
  }
}

TEST(DepthFaults, registration_shifts_depth_in_one_direction) {
  SensorFaults faults;
  faults.registration_px = 3;
  DepthScene view = wall_at(4);
  view.inverse_depth(cv::Rect(100, 60, 50, 40)).setTo(0.5F);
  const cv::Mat before = measure({}, view), after = measure(faults, view);
  const auto middle = [](const cv::Mat& depth) {
    cv::Mat near;
    cv::inRange(depth, 1, 3 * kUnitsPerM, near);
    std::vector<cv::Point> points;
    cv::findNonZero(near, points);
    cv::Point2d sum;
    for (const cv::Point& point : points) sum += cv::Point2d(point);
    return sum / static_cast<double>(points.size());
  };
  EXPECT_NEAR(cv::norm(middle(after) - middle(before)), 3, 0.8) << "whole pixels";
}

TEST(DepthFaults, parallax_depends_on_depth) {
  SensorFaults faults;
  faults.parallax_px_m = 6;
  const auto shift_px = [&](float depth_m) {
    return middle_of_near(measure(faults, object_at(depth_m))) - middle_of_near(measure({}, object_at(depth_m)));
  };
  EXPECT_NEAR(shift_px(1), 3, 0.3);
  EXPECT_NEAR(shift_px(2), 0, 0.3);
  EXPECT_EQ(hole_share(measure(faults, wall_at(2))), 0);
}

TEST(DepthFaults, registration_leaves_no_cracks_in_a_slanted_surface) {
  DepthScene view = wall_at(2);
  for (int column = 0; column < kWidth; ++column) {
    view.inverse_depth.col(column).setTo(0.5 + 0.002 * column);
  }
  SensorFaults faults;
  faults.parallax_px_m = 10;
  EXPECT_EQ(hole_share(measure(faults, view).colRange(10, kWidth - 10)), 0);
}

TEST(DepthFaults, systematic_error_is_relative) {
  SensorFaults faults;
  faults.depth_error = 0.02;
  for (const float depth_m : {1.0F, 3.0F}) {
    const double mean_m = cv::mean(measure(faults, wall_at(depth_m)))[0] / static_cast<double>(kUnitsPerM);
    EXPECT_NEAR(mean_m / static_cast<double>(depth_m), 1.02, 0.002);
  }
}

TEST(DepthFaults, are_the_same_for_the_same_frame_only) {
  SensorFaults faults;
  faults.noise_correlation_px = 5;
  faults.holes = 0.2;
  faults.flying_px = 3;
  faults.wrong_side_px = 2;
  const cv::Size size(kWidth, kHeight);
  const DepthFaults a(faults, {}, size, 1), b(faults, {}, size, 1), other(faults, {}, size, 2);
  const DepthScene view = object_at(2);
  const auto differ = [](const cv::Mat& x, const cv::Mat& y) { return cv::norm(x, y, cv::NORM_L1) > 0; };
  EXPECT_FALSE(differ(a.measure(view, 4), b.measure(view, 4)));
  EXPECT_TRUE(differ(a.measure(view, 4), a.measure(view, 5)));
  EXPECT_TRUE(differ(a.measure(view, 4), other.measure(view, 4)));
}

}  // namespace
}  // namespace rtd::camera::synthetic
