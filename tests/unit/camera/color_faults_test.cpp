// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/scene_camera.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

const cv::Size kSize(120, 80);
constexpr double kFps = 30;

cv::Mat grey(int level) {
  return {kSize, CV_8UC3, cv::Scalar::all(level)};
}

ColorFaults with_exposure(double ev) {
  SensorFaults faults;
  faults.exposure_ev = ev;
  return {faults, kSize, kFps, 1};
}

TEST(ColorFaults, none_leave_the_image) {
  const ColorFaults faults({}, kSize, kFps, 1);
  cv::Mat image = grey(100);
  faults.expose(image, 2.5);
  EXPECT_EQ(cv::norm(image, grey(100), cv::NORM_L1), 0);
  EXPECT_EQ(faults.compressed(image).data, image.data);
}

TEST(ColorFaults, vignetting_darkens_the_corners) {
  SensorFaults faults;
  faults.vignetting = 0.4;
  cv::Mat image = grey(200);
  ColorFaults(faults, kSize, kFps, 1).expose(image, 0);
  EXPECT_EQ(image.at<cv::Vec3b>(40, 60)[0], 200);
  for (const cv::Point corner : {cv::Point(0, 0), cv::Point(119, 0), cv::Point(0, 79), cv::Point(119, 79)}) {
    EXPECT_NEAR(image.at<cv::Vec3b>(corner)[1], 120, 1);
  }
}

TEST(ColorFaults, exposure_follows_the_light_with_a_lag_of_five_frames) {
  const ColorFaults faults = with_exposure(1.5);
  constexpr double kLagS = 5 / kFps;
  double largest_ev = 0;
  int decaying = 0, wrong = 0;
  for (double t_s = 1; t_s < 60; t_s += 1 / kFps) {
    const double error_ev = faults.exposure_error_ev(t_s);
    largest_ev = std::max(largest_ev, std::abs(error_ev));
    if (std::abs(error_ev) < 0.2) continue;
    ++wrong;
    if (std::abs(faults.exposure_error_ev(t_s + kLagS) / error_ev - std::exp(-1)) < 0.02) ++decaying;
  }
  EXPECT_EQ(faults.exposure_error_ev(0), 0);
  EXPECT_LE(largest_ev, 1.5);
  EXPECT_GT(largest_ev, 1.0);
  EXPECT_GT(wrong, 100);
  EXPECT_GT(decaying, wrong / 2) << "unless the light changes again meanwhile";
}

TEST(ColorFaults, a_stop_doubles_the_light) {
  const ColorFaults faults = with_exposure(1.5);
  double t_s = 1;
  while (std::abs(faults.exposure_error_ev(t_s) + 1) > 0.05) t_s += 0.01;  // one stop too dark
  cv::Mat image = grey(200);
  faults.expose(image, t_s);
  EXPECT_NEAR(image.at<cv::Vec3b>(3, 3)[0], 200 * std::pow(0.5, 1 / 2.2), 5);
}

TEST(ColorFaults, jpeg_loses_little) {
  SensorFaults faults;
  faults.jpeg = 80;
  cv::Mat image(kSize, CV_8UC3);
  SeededRandom random(1);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      image.at<cv::Vec3b>(row, column) = cv::Vec3b::all(static_cast<std::uint8_t>(100 + column / 2 + random.index(9)));
    }
  }
  const cv::Mat compressed = ColorFaults(faults, kSize, kFps, 1).compressed(image);
  ASSERT_EQ(compressed.size(), image.size());
  const double rms = cv::norm(compressed, image) / std::sqrt(static_cast<double>(3 * image.total()));
  EXPECT_GT(rms, 0.5);
  EXPECT_LT(rms, 5);
}

}  // namespace
}  // namespace rtd::camera::synthetic
