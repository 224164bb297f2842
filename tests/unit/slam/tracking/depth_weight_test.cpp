// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include <random>

#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/tracking/readout_estimator.hpp"

namespace rtd::slam {
namespace {

constexpr vision::RgbdProjection kWeighingCamera{500, 500, 320, 240};

/// A frame that shows 300 points at 1 to 4 m with these errors (standard deviations), seen from the origin.
struct NoisyFrame {
  Frame frame;
  std::vector<Association> points;

  NoisyFrame(double pixel_px, double inverse_depth_per_m, std::uint32_t seed, std::uint32_t count = 300) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> u(20, 620), v(20, 460), z(1, 4);
    frame.camera = kWeighingCamera;
    for (std::uint32_t i = 0; i < count; ++i) {
      msg::Feature feature{};
      const double u_px = u(random), v_px = v(random), z_m = z(random);
      feature.u_px = static_cast<float>(u_px + pixel_px * normal(random));
      feature.v_px = static_cast<float>(v_px + pixel_px * normal(random));
      feature.depth_m = static_cast<float>(1 / (1 / z_m + inverse_depth_per_m * normal(random)));
      frame.features.push_back(feature);
      points.push_back({i,
                        i,
                        {(u_px - kWeighingCamera.cx) / kWeighingCamera.fx * z_m,
                         (v_px - kWeighingCamera.cy) / kWeighingCamera.fy * z_m, z_m}});
    }
  }
};

double after(int frames, double pixel_px, double inverse_depth_per_m, std::uint32_t points = 300) {
  DepthWeightEstimator estimator;
  for (int i = 0; i < frames; ++i) {
    const NoisyFrame seen(pixel_px, inverse_depth_per_m, static_cast<std::uint32_t>(i), points);
    estimator.add(seen.frame, Eigen::Isometry3d::Identity(), seen.points);
  }
  return estimator.disparity_px_m();
}

TEST(DepthWeight, starts_with_a_weight_that_suits_most) {
  EXPECT_EQ(DepthWeightEstimator().disparity_px_m(), 80.0);
  EXPECT_EQ(DepthWeightEstimator(70.0).disparity_px_m(), 70.0);
}

TEST(DepthWeight, follows_the_ratio_of_the_errors) {
  EXPECT_NEAR(after(100, 1.0, 1.0 / 150), 67.5, 7.0);
  EXPECT_NEAR(after(100, 1.0, 1.0 / 50), 22.5, 3.5);
  EXPECT_NEAR(after(100, 0.5, 0.5 / 150), 67.5, 7.0);
}

TEST(DepthWeight, the_first_frames_change_it_little) {
  EXPECT_NEAR(after(1, 1.0, 1.0 / 50), 68.0, 5.0);
}

TEST(DepthWeight, stays_within_bounds_without_noise) {
  EXPECT_NEAR(after(100, 0.01, 0), 80.0, 8.0);
  EXPECT_NEAR(after(100, 0.01, 0.1), 10.0, 1.0);
}

TEST(DepthWeight, learns_nothing_from_few_points_or_without_depth) {
  EXPECT_EQ(after(100, 1.0, 1.0 / 50, 20), 80.0);
  NoisyFrame seen(1.0, 1.0 / 50, 1);
  for (msg::Feature& feature : seen.frame.features) feature.depth_m = 0;
  DepthWeightEstimator estimator;
  for (int i = 0; i < 100; ++i) estimator.add(seen.frame, Eigen::Isometry3d::Identity(), seen.points);
  EXPECT_EQ(estimator.disparity_px_m(), 80.0);
}

TEST(ReadoutEstimator, continues_from_what_a_map_knows) {
  EXPECT_NEAR(ReadoutEstimator(0.02).readout_s(), 0.02, 1e-12) << "sure from the first frame on";
  EXPECT_LT(ReadoutEstimator(0.02).sigma_s(), 0.005) << "but other frames may correct it";
  EXPECT_EQ(ReadoutEstimator(0).readout_s(), 0);
}

}  // namespace
}  // namespace rtd::slam
