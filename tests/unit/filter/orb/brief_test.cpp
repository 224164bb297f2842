// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/brief.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "common/vision/features.hpp"
#include "services/filter/core/orb/corners.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

TEST(BriefPattern, stays_inside_the_patch_when_rotated) {
  const BriefPattern& pattern = brief_pattern();
  for (std::size_t i = 0; i < pattern.x.size(); ++i) {
    EXPECT_LE(std::hypot(pattern.x[i], pattern.y[i]), kPatchRadiusPx - 1) << "point " << i;
  }
}

TEST(BriefPattern, has_no_duplicate_comparison) {
  const BriefPattern& pattern = brief_pattern();
  std::set<std::array<float, 4>> seen;
  for (std::size_t k = 0; k < BriefPattern::kBits; ++k) {
    const std::array<float, 4> pair{pattern.x[2 * k], pattern.y[2 * k], pattern.x[2 * k + 1], pattern.y[2 * k + 1]};
    EXPECT_TRUE(seen.insert(pair).second);
    EXPECT_TRUE(seen.insert({pair[2], pair[3], pair[0], pair[1]}).second);
  }
}

TEST(RotatedBrief, differs_in_half_of_the_bits_between_unlike_patches) {
  const cv::Mat image = test::textured_image();
  double sum = 0;
  int count = 0;
  for (int x = 40; x < 600; x += 40) {
    for (int y = 40; y < 400; y += 40, ++count) {
      sum += vision::hamming_distance(rotated_brief(image, {x, y}, 0), rotated_brief(image, {x + 20, y + 37}, 0));
    }
  }
  EXPECT_NEAR(sum / count, 128, 12) << "mean bits";
}

TEST(RotatedBrief, rotated_by_the_angle_matches_a_rotated_patch) {
  cv::Mat image = test::textured_image({121, 121});
  cv::GaussianBlur(image, image, cv::Size(7, 7), 2);
  const msg::Descriptor upright = rotated_brief(image, {60, 60}, 0);
  for (const double degrees : {30.0, 90.0, 145.0, 180.0, -75.0}) {
    cv::Mat turned;
    cv::warpAffine(image, turned, cv::getRotationMatrix2D({60, 60}, -degrees, 1), image.size());
    const auto angle = static_cast<float>(degrees * CV_PI / 180);
    EXPECT_LE(vision::hamming_distance(upright, rotated_brief(turned, {60, 60}, angle)), 25) << degrees << " degrees";
  }
}

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
