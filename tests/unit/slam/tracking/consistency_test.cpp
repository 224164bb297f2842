// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rtd::slam {
namespace {

constexpr double kPeriod_s = 0.033, kScene_m = 3, kSigma_m = 0.001;

/// A frame that was tracked: `inliers` landmarks 2 m away and off by `error_px` (standard deviation), others rejected.
struct Tracked {
  Frame frame;
  LocalMap map;
  LocalMapTracking tracking;

  Tracked(std::uint32_t inliers, std::uint32_t rejected, double error_px, std::uint32_t seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, error_px);
    std::uniform_real_distribution<double> u(20, 620), v(20, 460);
    frame.camera = {500, 500, 320, 240};
    for (std::uint32_t i = 0; i < inliers; ++i) {
      msg::Feature feature{};
      const double u_px = u(random), v_px = v(random);
      feature.u_px = static_cast<float>(u_px + error(random));
      feature.v_px = static_cast<float>(v_px + error(random));
      frame.features.push_back(feature);
      LocalLandmark landmark;
      landmark.id = i;
      landmark.position = {(u_px - 320) / 500 * 2, (v_px - 240) / 500 * 2, 2};
      map.landmarks.push_back(landmark);
      tracking.guess.landmarks.push_back(i);
    }
    tracking.guess.success = true;
    tracking.guess.inliers = static_cast<int>(inliers);
    tracking.rejected.resize(rejected);
  }
};

Consistency after(int frames, const Tracked& seen, double period_s = kPeriod_s) {
  Consistency consistency{ConsistencyConfig{}};
  for (int i = 0; i < frames; ++i) consistency.add(seen.frame, seen.map, seen.tracking, period_s);
  return consistency;
}

TEST(Consistency, trusts_a_pose_that_most_of_the_image_agrees_with) {
  Consistency good = after(60, Tracked(300, 80, 0.5));
  EXPECT_NEAR(good.value(), 300.0 / 380, 0.03);
  EXPECT_FALSE(good.doubts(kSigma_m));
  EXPECT_EQ(good.covariance(kScene_m).trace(), 0);
}

TEST(Consistency, doubts_a_pose_that_much_of_the_image_contradicts) {
  Consistency bad = after(60, Tracked(300, 450, 0.5));
  EXPECT_NEAR(bad.value(), 0.4, 0.03);
  EXPECT_TRUE(bad.doubts(kSigma_m));
  EXPECT_GT(std::sqrt(bad.covariance(kScene_m)(0, 0)), 0.05) << "m";
  EXPECT_NEAR(bad.covariance(kScene_m)(3, 3), bad.covariance(kScene_m)(0, 0) / (kScene_m * kScene_m), 1e-9);
}

TEST(Consistency, doubts_a_pose_that_the_image_agrees_with_loosely) {
  EXPECT_TRUE(after(60, Tracked(300, 150, 1.3)).doubts(kSigma_m));
  EXPECT_FALSE(after(60, Tracked(300, 100, 0.7)).doubts(kSigma_m)) << "a coarser sensor";
}

TEST(Consistency, doubts_an_uncertain_pose_the_sooner_the_less_agrees) {
  Consistency good = after(60, Tracked(300, 100, 0.5)), poor = after(60, Tracked(300, 300, 0.5));  // 0.75, 0.50
  EXPECT_FALSE(good.doubts(0.012));
  EXPECT_TRUE(good.doubts(0.04));
  EXPECT_TRUE(poor.doubts(0.012));
  EXPECT_FALSE(poor.doubts(kSigma_m));
}

TEST(Consistency, is_certain_again_only_when_clearly_below_the_limit) {
  Consistency consistency = after(60, Tracked(300, 128, 0.5));  // 0.70
  const double limit_m = 0.02 * std::exp(7 * (consistency.value() - 0.7));
  EXPECT_NEAR(limit_m, 0.02, 0.003);
  EXPECT_FALSE(consistency.doubts(0.95 * limit_m));
  EXPECT_TRUE(consistency.doubts(1.05 * limit_m));
  EXPECT_TRUE(consistency.doubts(0.95 * limit_m));
  EXPECT_FALSE(consistency.doubts(0.9 * limit_m));
}

TEST(Consistency, never_doubts_with_a_share_of_0) {
  ConsistencyConfig config;
  config.doubtful_below = 0;
  EXPECT_FALSE(Consistency{config}.doubts(1));
}

TEST(Consistency, looks_at_time_and_not_at_frames) {
  const Tracked bad(300, 450, 0.5);
  EXPECT_FALSE(after(3, bad).doubts(kSigma_m)) << "a tenth of a second";
  EXPECT_TRUE(after(60, bad).doubts(kSigma_m));
  EXPECT_NEAR(after(10, bad, 0.2).value(), after(60, bad).value(), 0.01) << "two seconds at 5 Hz";
}

TEST(Consistency, says_nothing_about_a_handful_of_matches) {
  EXPECT_FALSE(after(60, Tracked(8, 11, 2)).doubts(kSigma_m));
}

TEST(Consistency, trusts_again_only_when_clearly_better) {
  Consistency consistency = after(60, Tracked(300, 450, 0.5));  // 0.40
  EXPECT_TRUE(consistency.doubts(kSigma_m));
  const Tracked little_better(300, 380, 0.5), good(300, 80, 0.5);
  for (int i = 0; i < 60; ++i) {
    consistency.add(little_better.frame, little_better.map, little_better.tracking, kPeriod_s);
  }
  EXPECT_TRUE(consistency.doubts(kSigma_m)) << "0.44";
  for (int i = 0; i < 60; ++i) consistency.add(good.frame, good.map, good.tracking, kPeriod_s);
  EXPECT_FALSE(consistency.doubts(kSigma_m));
  consistency.reset();
  EXPECT_FALSE(consistency.doubts(kSigma_m));
}

}  // namespace
}  // namespace rtd::slam
