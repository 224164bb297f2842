// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/orb_extractor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

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
