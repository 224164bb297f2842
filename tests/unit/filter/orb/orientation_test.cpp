// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/brief.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rtd::filter {
namespace {

TEST(Orientation, points_to_the_bright_side) {
  for (double angle = -3.0; angle < 3.1; angle += 0.25) {
    cv::Mat ramp(61, 61, CV_8UC1);
    for (int y = 0; y < ramp.rows; ++y) {
      for (int x = 0; x < ramp.cols; ++x) {
        ramp.at<std::uint8_t>(y, x) =
            cv::saturate_cast<std::uint8_t>(128 + 4 * ((x - 30) * std::cos(angle) + (y - 30) * std::sin(angle)));
      }
    }
    EXPECT_NEAR(centroid_angle_rad(ramp, {30, 30}), angle, 0.02) << "rad";
  }
}

TEST(Orientation, of_a_flat_patch_is_zero) {
  EXPECT_EQ(centroid_angle_rad(cv::Mat(61, 61, CV_8UC1, cv::Scalar(90)), {30, 30}), 0.0F);
}

}  // namespace
}  // namespace rtd::filter
