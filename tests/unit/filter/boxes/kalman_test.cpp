// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/kalman.hpp"

#include <gtest/gtest.h>

#include <random>

namespace rtd::filter {
namespace {

constexpr double kDetectionPeriodS = 1.0 / 30;

Box box(double x, double y, double width, double height) {
  return {{x, y}, {width, height}};
}

TEST(BoxKalman, learns_a_constant_velocity) {
  BoxKalman filter(box(100, 200, 80, 200));
  for (int i = 1; i <= 30; ++i) {
    filter.predict(kDetectionPeriodS);
    filter.detected(box(100 + 4 * i, 200, 80, 200));
  }
  EXPECT_NEAR(filter.velocity_px_s().x(), 120, 5) << "px/s";
  filter.predict(0.2);
  EXPECT_NEAR(filter.box().centre_px.x(), 100 + 4 * 36, 3) << "px, six frames later";
}

TEST(BoxKalman, is_closer_to_the_truth_than_noisy_boxes) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 4);
  BoxKalman filter(box(100, 200, 80, 200));
  double filtered = 0, raw = 0;
  for (int i = 1; i <= 200; ++i) {
    const double truth = 100 + 2 * i, seen = truth + noise(random);
    filter.predict(kDetectionPeriodS);
    filter.detected(box(seen, 200, 80, 200));
    filtered += std::pow(filter.box().centre_px.x() - truth, 2);
    raw += std::pow(seen - truth, 2);
  }
  EXPECT_LT(filtered, 0.7 * raw);
}

TEST(BoxKalman, follows_the_flow_without_a_detection) {
  BoxKalman filter(box(100, 200, 80, 200));
  for (int i = 0; i < 15; ++i) {  // half a second, the object turns round in the middle
    filter.flowed({{i < 7 ? 5.0 : -5.0, 0}, 1.01}, kDetectionPeriodS);
    filter.predict(kDetectionPeriodS);
  }
  EXPECT_NEAR(filter.box().centre_px.x(), 100 - 5, 6) << "px";
  EXPECT_NEAR(filter.box().size_px.x(), 80 * std::pow(1.01, 15), 2) << "px";
}

TEST(BoxKalman, becomes_less_certain_without_measurements_and_more_with_them) {
  BoxKalman filter(box(100, 200, 80, 200));
  const double first = filter.sigma_px(0);
  filter.predict(0.5);
  const double later = filter.sigma_px(0);
  filter.detected(box(100, 200, 80, 200));
  EXPECT_GT(later, first);
  EXPECT_LT(filter.sigma_px(0), first);
}

TEST(BoxKalman, treats_large_and_small_boxes_alike) {
  BoxKalman small(box(100, 100, 20, 50)), large(box(1000, 1000, 200, 500));
  for (int i = 1; i <= 5; ++i) {
    small.predict(kDetectionPeriodS);
    large.predict(kDetectionPeriodS);
    small.detected(box(100 + i, 100, 20, 50));
    large.detected(box(1000 + 10 * i, 1000, 200, 500));
  }
  EXPECT_NEAR(10 * small.box().centre_px.x(), large.box().centre_px.x(), 1e-9) << "px";
}

TEST(BoxKalman, stays_a_box_whatever_is_measured) {
  BoxKalman filter(box(100, 100, 20, 50));
  for (int i = 0; i < 100; ++i) {
    filter.flowed({{1e4, -1e4}, 0.01}, kDetectionPeriodS);
    filter.predict(kDetectionPeriodS);
  }
  EXPECT_GE(filter.box().size_px.minCoeff(), 1.0);
  EXPECT_TRUE(filter.box().centre_px.allFinite());
  filter.predict(-5);
  filter.predict(0);
  EXPECT_TRUE(filter.box().centre_px.allFinite());
}

TEST(Boxes, overlap_as_shared_over_joint_area) {
  EXPECT_DOUBLE_EQ(intersection_over_union(box(50, 50, 100, 100), box(50, 50, 100, 100)), 1.0);
  EXPECT_DOUBLE_EQ(intersection_over_union(box(50, 50, 100, 100), box(100, 50, 100, 100)), 1.0 / 3);
  EXPECT_DOUBLE_EQ(intersection_over_union(box(50, 50, 100, 100), box(250, 50, 100, 100)), 0.0);
}

}  // namespace
}  // namespace rtd::filter
