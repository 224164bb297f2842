// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/shrink.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rtd::filter {
namespace {

TEST(Shrink, gives_the_pixels_of_opencv) {
  cv::theRNG().state = 11;
  for (const cv::Size size :
       {cv::Size(640, 480), cv::Size(333, 61), cv::Size(40, 40), cv::Size(17, 9), cv::Size(5, 5)}) {
    cv::Mat image(size, CV_8UC1), expected, found;
    cv::randu(image, 0, 256);
    for (const double scale : {1.01, 1.05, 1.2, 1.3, 1.5, 1.79, 1.8, 2.0, 2.5, 0.9}) {
      const cv::Size smaller(static_cast<int>(std::lround(size.width / scale)),
                             static_cast<int>(std::lround(size.height / scale)));
      cv::resize(image, expected, smaller, 0, 0, cv::INTER_LINEAR);
      shrink(image, smaller, found);
      ASSERT_EQ(found.size(), smaller);
      EXPECT_EQ(cv::norm(expected, found, cv::NORM_INF), 0) << size << " by " << scale;
    }
  }
}

}  // namespace
}  // namespace rtd::filter
