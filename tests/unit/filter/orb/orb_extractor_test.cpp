// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/orb_extractor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/vision/features.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

using test::rgbd_image;
using test::textured_image;

/// How many features of `a` have their nearest descriptor of `b` within 5 px of where `expected` puts them.
template <class Expected>
double share_found_again(const std::vector<msg::Feature>& a, const std::vector<msg::Feature>& b, Expected expected) {
  int offered = 0, found = 0;
  for (const msg::Feature& feature : a) {
    const cv::Point2f target = expected(cv::Point2f(feature.u_px, feature.v_px));
    if (!cv::Rect2f(30, 30, 580, 420).contains(target)) continue;
    ++offered;
    const auto best = std::min_element(b.begin(), b.end(), [&](const msg::Feature& x, const msg::Feature& y) {
      return vision::hamming_distance(x.descriptor, feature.descriptor) <
             vision::hamming_distance(y.descriptor, feature.descriptor);
    });
    found += std::hypot(best->u_px - target.x, best->v_px - target.y) < 5 ? 1 : 0;
  }
  return static_cast<double>(found) / offered;
}

TEST(OrbExtractor, gives_the_wanted_number_on_textured_images) {
  OrbExtractor extractor{OrbConfig{}};
  EXPECT_NEAR(static_cast<double>(extractor.extract(rgbd_image(textured_image())).size()), 1000, 20);
  EXPECT_NEAR(static_cast<double>(extractor.extract(rgbd_image(textured_image()), 1500).size()), 1500, 20);
}

TEST(OrbExtractor, leaves_out_fine_octaves_and_finds_the_same_places_in_the_others) {
  OrbExtractor extractor{OrbConfig{}}, coarse_extractor{OrbConfig{}};
  const std::vector<msg::Feature> all = extractor.extract(rgbd_image(textured_image()), 1000);
  const std::vector<msg::Feature> coarse = coarse_extractor.extract(rgbd_image(textured_image()), 400, 3);
  EXPECT_NEAR(static_cast<double>(coarse.size()), 400, 20);
  std::size_t known = 0;
  for (const msg::Feature& feature : coarse) {
    ASSERT_GE(feature.octave, 3);
    known += std::ranges::any_of(all, [&feature](const msg::Feature& other) {
      return other.octave >= 2 && std::hypot(other.u_px - feature.u_px, other.v_px - feature.v_px) < 3;
    });
  }
  EXPECT_GT(known, coarse.size() / 2) << "the pyramid without its fine levels shows the same image";
}

TEST(OrbExtractor, gives_the_same_bits_twice) {
  OrbExtractor first{OrbConfig{}}, second{OrbConfig{}};
  const vision::RgbdImage image = rgbd_image(textured_image());
  second.extract(rgbd_image(textured_image({640, 480}, 99)));  // used buffers must not matter
  const std::vector<msg::Feature> a = first.extract(image), b = second.extract(image);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(msg::Feature)), 0);
}

TEST(OrbExtractor, is_recognised_after_rotation) {
  OrbExtractor extractor{OrbConfig{}};
  const cv::Mat image = textured_image();
  const std::vector<msg::Feature> upright = extractor.extract(rgbd_image(image));
  for (const double degrees : {20.0, 45.0, 90.0, 180.0}) {
    const cv::Mat rotation = cv::getRotationMatrix2D({319.5F, 239.5F}, degrees, 1);
    cv::Mat turned;
    cv::warpAffine(image, turned, rotation, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
    const auto expected = [&](cv::Point2f p) {
      const double* r = rotation.ptr<double>();
      return cv::Point2f(static_cast<float>(r[0] * p.x + r[1] * p.y + r[2]),
                         static_cast<float>(r[3] * p.x + r[4] * p.y + r[5]));
    };
    EXPECT_GE(share_found_again(upright, extractor.extract(rgbd_image(turned)), expected), 0.45)
        << degrees << " degrees";
  }
}

TEST(OrbExtractor, is_recognised_after_a_change_of_scale) {
  OrbExtractor extractor{OrbConfig{}};
  const cv::Mat image = textured_image();
  cv::Mat larger;
  cv::resize(image, larger, {}, 1.2, 1.2);
  const cv::Rect centre(64, 48, 640, 480);
  const auto expected = [](cv::Point2f p) {
    return cv::Point2f((p.x + 0.5F) * 1.2F - 64.5F, (p.y + 0.5F) * 1.2F - 48.5F);
  };
  EXPECT_GE(
      share_found_again(extractor.extract(rgbd_image(image)), extractor.extract(rgbd_image(larger(centre))), expected),
      0.55);
}

TEST(OrbExtractor, places_a_blob_at_the_same_point_in_all_octaves) {
  OrbExtractor extractor{OrbConfig{}};
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(40));
  cv::circle(image, {320, 240}, 60, cv::Scalar(220), cv::FILLED);
  double sum_u = 0, sum_v = 0;
  const std::vector<msg::Feature> features = extractor.extract(rgbd_image(image));
  int count = 0;
  for (const msg::Feature& feature : features) {
    if (feature.octave < 5) continue;
    sum_u += feature.u_px;
    sum_v += feature.v_px;
    ++count;
  }
  ASSERT_GT(count, 4);
  EXPECT_NEAR(sum_u / count, 320, 2.0) << "px";
  EXPECT_NEAR(sum_v / count, 240, 2.0) << "px";
}

TEST(OrbExtractor, reads_depth_and_rejects_values_out_of_range) {
  OrbExtractor extractor{OrbConfig{}};
  vision::RgbdImage image = rgbd_image(textured_image(), 2.0);
  image.depth.colRange(0, 200).setTo(0);
  image.depth.colRange(200, 300).setTo(65535);
  for (const msg::Feature& feature : extractor.extract(image)) {
    if (feature.u_px < 299) {
      EXPECT_EQ(feature.depth_m, 0.0F);
    } else if (feature.u_px > 301) {
      EXPECT_NEAR(feature.depth_m, 2.0, 1e-4);
    }
  }
}

TEST(OrbExtractor, finds_nothing_in_a_uniform_or_tiny_image) {
  OrbExtractor extractor{OrbConfig{}};
  EXPECT_TRUE(extractor.extract(rgbd_image(cv::Mat(480, 640, CV_8UC1, cv::Scalar(77)))).empty());
  EXPECT_TRUE(extractor.extract(rgbd_image(cv::Mat(8, 8, CV_8UC1, cv::Scalar(77)))).empty());
}

TEST(UndistortionTable, agrees_with_the_exact_solution_for_the_tum_camera) {
  geometry::CameraModel::Parameters p = test::pinhole().parameters();
  p.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  const geometry::CameraModel camera(p);
  UndistortionTable table;
  table.fit(camera);
  for (int v = 3; v < 480; v += 17) {
    for (int u = 1; u < 640; u += 13) {
      const Eigen::Vector2d exact = camera.undistort({u, v});
      const cv::Point2f looked_up = table.undistort({static_cast<float>(u), static_cast<float>(v)});
      EXPECT_NEAR(looked_up.x, exact.x(), 0.02) << "px at " << u << " " << v;
      EXPECT_NEAR(looked_up.y, exact.y(), 0.02) << "px at " << u << " " << v;
    }
  }
}

TEST(UndistortionTable, leaves_pixels_alone_without_distortion) {
  UndistortionTable table;
  table.fit(test::pinhole());
  EXPECT_EQ(table.undistort({12.25F, 400.5F}), cv::Point2f(12.25F, 400.5F));
}

}  // namespace
}  // namespace rtd::filter
