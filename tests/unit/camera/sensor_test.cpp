// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/sensor.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace rtd::camera::synthetic {
namespace {

cv::Mat wall_at(float depth_m) {
  return cv::Mat(100, 200, CV_32FC1, cv::Scalar(1.0F / depth_m));
}

struct Statistics {
  double mean_m = 0, sigma_m = 0, measured = 0;
};

Statistics statistics_of(const cv::Mat& depth) {
  double sum = 0, squares = 0, count = 0;
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const double depth_m = depth.at<std::uint16_t>(row, column) / 5000.0;
      if (depth_m == 0) continue;
      sum += depth_m;
      squares += depth_m * depth_m;
      ++count;
    }
  }
  return {sum / count, std::sqrt(squares / count - sum / count * sum / count),
          count / static_cast<double>(depth.total())};
}

TEST(Sensor, noise_grows_with_the_square_of_depth) {
  const Sensor sensor({}, 1);
  for (const float depth_m : {1.0F, 2.0F, 4.0F}) {
    const Statistics measured = statistics_of(sensor.measure_depth(wall_at(depth_m), 0));
    EXPECT_NEAR(measured.mean_m, depth_m, 0.0015 * depth_m * depth_m) << "unbiased within a fraction of the noise";
    EXPECT_GT(measured.sigma_m, 0.0008 * depth_m * depth_m);
    EXPECT_LT(measured.sigma_m, 0.0022 * depth_m * depth_m);
    EXPECT_EQ(measured.measured, 1.0);
  }
}

TEST(Sensor, measures_nothing_out_of_range) {
  const Sensor sensor({}, 1);
  EXPECT_EQ(cv::countNonZero(sensor.measure_depth(wall_at(0.3F), 0)), 0);
  EXPECT_EQ(cv::countNonZero(sensor.measure_depth(wall_at(7.0F), 0)), 0);
  EXPECT_EQ(cv::countNonZero(sensor.measure_depth(cv::Mat(10, 10, CV_32FC1, cv::Scalar(0)), 0)), 0);
}

TEST(Sensor, loses_the_projectors_shadow_left_of_a_near_object) {
  cv::Mat scene = wall_at(4);
  scene.colRange(100, 150).setTo(1.0F);  // 1 m
  const cv::Mat depth = Sensor({}, 1).measure_depth(scene, 0);
  const int shadow = 50 - cv::countNonZero(depth.row(50).colRange(50, 100));
  EXPECT_NEAR(shadow, 43.5 * (1.0 - 0.25), 2) << "baseline x focal length x difference of 1/z";
  EXPECT_EQ(cv::countNonZero(depth.row(50).colRange(152, 200)), 48) << "none on the right";
}

TEST(Sensor, ideal_sensor_only_rounds) {
  SensorModel model;
  model.noise = false;
  const Sensor sensor(model, 1);
  const cv::Mat depth = sensor.measure_depth(wall_at(2.34567F), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(5, 5), 11728);
  const cv::Mat color(10, 10, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_EQ(cv::norm(sensor.measure_color(color, 0), color), 0);
}

TEST(Sensor, noise_is_the_same_for_the_same_frame_only) {
  const Sensor a({}, 1), b({}, 1), other({}, 2);
  const cv::Mat wall = wall_at(3);
  const auto differ = [](const cv::Mat& x, const cv::Mat& y) { return cv::norm(x, y, cv::NORM_L1) > 0; };
  EXPECT_FALSE(differ(a.measure_depth(wall, 4), b.measure_depth(wall, 4)));
  EXPECT_TRUE(differ(a.measure_depth(wall, 4), a.measure_depth(wall, 5)));
  EXPECT_TRUE(differ(a.measure_depth(wall, 4), other.measure_depth(wall, 4)));
}

TEST(Sensor, colour_noise_has_the_stated_deviation) {
  const cv::Mat grey(100, 200, CV_8UC3, cv::Scalar::all(128));
  cv::Scalar mean, deviation;
  cv::meanStdDev(Sensor({}, 1).measure_color(grey, 3), mean, deviation);
  EXPECT_NEAR(mean[0], 128, 0.1);
  EXPECT_NEAR(deviation[1], 2.0, 0.15);
}

TEST(Sensor, has_noise_for_rows_wider_than_640_px) {
  const Sensor sensor({}, 1);
  const cv::Mat grey(600, Sensor::kWidestRowPx, CV_8UC3, cv::Scalar::all(128));
  cv::Scalar mean, deviation;
  cv::meanStdDev(sensor.measure_color(grey, 3).colRange(3000, Sensor::kWidestRowPx), mean, deviation);
  EXPECT_NEAR(mean[0], 128, 0.1);
  EXPECT_NEAR(deviation[1], 2.0, 0.15);
  const cv::Mat too_wide(1, Sensor::kWidestRowPx + 1, CV_8UC3, cv::Scalar::all(128));
  EXPECT_THROW(sensor.measure_color(too_wide, 0), std::invalid_argument);
}

}  // namespace
}  // namespace rtd::camera::synthetic
