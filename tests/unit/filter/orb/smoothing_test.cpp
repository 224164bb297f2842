// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "services/filter/core/orb/shrink.hpp"

namespace rtd::filter {
namespace {

TEST(Smoothing, gives_the_pixels_of_opencv) {
  cv::theRNG().state = 3;
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(77, 45), cv::Size(7, 7), cv::Size(4, 90)}) {
    cv::Mat grey(size, CV_8UC1), expected, smoothed;
    cv::randu(grey, 0, 256);
    cv::GaussianBlur(grey, expected, cv::Size(7, 7), 2, 2, cv::BORDER_REFLECT_101);
    smooth(grey, smoothed);
    EXPECT_EQ(cv::norm(expected, smoothed, cv::NORM_INF), 0) << size;
  }
}

TEST(Smoothing, keeps_black_and_white) {
  cv::Mat smoothed;
  for (const int grey : {0, 255}) {
    smooth(cv::Mat(50, 60, CV_8UC1, cv::Scalar(grey)), smoothed);
    EXPECT_EQ(cv::countNonZero(smoothed != grey), 0);
  }
}

}  // namespace
}  // namespace rtd::filter
