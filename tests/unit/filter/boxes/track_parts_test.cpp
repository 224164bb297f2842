// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "services/filter/core/boxes/assignment.hpp"
#include "services/filter/core/boxes/kalman.hpp"
#include "services/filter/core/boxes/object_tracker.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

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

/// Tries everything: the smallest sum for the rows from `row` on.
double cheapest(const CostMatrix& costs, double max_cost, int row, std::vector<char>& taken) {
  if (row == costs.rows) return 0;
  double best = max_cost + cheapest(costs, max_cost, row + 1, taken);
  for (int column = 0; column < costs.columns; ++column) {
    const double cost = costs.at(row, column);
    if (taken[static_cast<std::size_t>(column)] != 0 || !std::isfinite(cost) || cost >= max_cost) continue;
    taken[static_cast<std::size_t>(column)] = 1;
    best = std::min(best, cost + cheapest(costs, max_cost, row + 1, taken));
    taken[static_cast<std::size_t>(column)] = 0;
  }
  return best;
}

double sum_of(const CostMatrix& costs, const std::vector<int>& column_of, double max_cost) {
  double sum = 0;
  std::set<int> used;
  for (int row = 0; row < costs.rows; ++row) {
    const int column = column_of[static_cast<std::size_t>(row)];
    EXPECT_TRUE(column < 0 || used.insert(column).second) << "column twice";
    sum += column < 0 ? max_cost : costs.at(row, column);
  }
  return sum;
}

TEST(Assignment, is_as_cheap_as_the_best_of_all_possible_ones) {
  constexpr double kMaxCost = 0.7;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> cost(0, 1);
  for (int trial = 0; trial < 400; ++trial) {
    CostMatrix costs(static_cast<int>(random() % 6), static_cast<int>(random() % 7));
    for (double& value : costs.cost) value = random() % 8 == 0 ? std::numeric_limits<double>::infinity() : cost(random);
    std::vector<char> taken(static_cast<std::size_t>(costs.columns), 0);
    EXPECT_NEAR(sum_of(costs, assign(costs, kMaxCost), kMaxCost), cheapest(costs, kMaxCost, 0, taken), 1e-12)
        << "trial " << trial;
  }
}

TEST(Assignment, leaves_a_column_to_a_row_that_has_no_other_choice) {
  CostMatrix costs(2, 2);
  costs.at(0, 0) = 0.1;
  costs.at(0, 1) = 0.2;
  costs.at(1, 0) = 0.3;
  EXPECT_EQ(assign(costs, 1.0), (std::vector<int>{1, 0}));
}

TEST(Assignment, does_not_assign_rows_whose_pairs_cost_too_much_or_are_not_finite) {
  CostMatrix costs(3, 3);
  costs.at(0, 0) = 2.0;
  costs.at(1, 1) = std::nan("");
  costs.at(2, 2) = 0.5;
  EXPECT_EQ(assign(costs, 1.0), (std::vector<int>{-1, -1, 2}));
}

TEST(Assignment, accepts_empty_sides) {
  EXPECT_TRUE(assign(CostMatrix(0, 5), 1.0).empty());
  EXPECT_EQ(assign(CostMatrix(2, 0), 1.0), (std::vector<int>{-1, -1}));
}

const Box kMaskBox{{320, 240}, {200, 160}};

/// A texture scaled about the image's centre and shifted.
cv::Mat picture(double shift_x_px, double scale = 1) {
  static const cv::Mat texture = test::textured_image();
  const cv::Mat affine =
      (cv::Mat_<double>(2, 3) << scale, 0, 320 * (1 - scale) + shift_x_px, 0, scale, 240 * (1 - scale));
  cv::Mat moved, color;
  cv::warpAffine(texture, moved, affine, texture.size());
  cv::cvtColor(moved, color, cv::COLOR_GRAY2BGR);
  return color;
}
std::vector<cv::Point2f> points_in_box() {
  std::vector<cv::Point2f> points;
  for (int y = 180; y <= 300; y += 30) {
    for (int x = 240; x <= 400; x += 40) points.emplace_back(static_cast<float>(x), static_cast<float>(y));
  }
  return points;
}

TEST(MaskFlow, finds_the_shift_of_a_box) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, picture(13));
  const auto motion = flow.follow(1, 2, kMaskBox, points_in_box());
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->flow.shift_px.x(), 13, 0.5) << "px";
  EXPECT_NEAR(motion->flow.shift_px.y(), 0, 0.5) << "px";
  EXPECT_NEAR(motion->flow.scale, 1, 0.01);
}

TEST(MaskFlow, finds_the_scale_of_an_approaching_box) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, picture(0, 1.06));
  const auto motion = flow.follow(1, 2, kMaskBox, points_in_box());
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->flow.scale, 1.06, 0.015);
  EXPECT_NEAR(motion->flow.shift_px.norm(), 0, 1.0) << "px";
}

TEST(MaskFlow, returns_nothing_where_no_point_is_found_again) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(128)));
  EXPECT_FALSE(flow.follow(1, 2, kMaskBox, points_in_box()));
}

TEST(MaskFlow, takes_images_that_are_one_pixel_wide_or_high) {
  for (const cv::Size size : {cv::Size(1, 1), {1, 480}, {640, 1}, {3, 1}}) {
    MaskFlow flow;
    flow.see(1, cv::Mat(size, CV_8UC3, cv::Scalar::all(90)));
    flow.see(2, cv::Mat(size, CV_8UC3, cv::Scalar::all(100)));
    EXPECT_NO_THROW(flow.follow(1, 2, kMaskBox, points_in_box())) << size;
  }
}

TEST(MaskFlow, returns_nothing_for_unknown_images_and_too_few_points) {
  MaskFlow flow;
  flow.see(1, picture(0));
  flow.see(2, picture(1));
  EXPECT_FALSE(flow.follow(0, 2, kMaskBox, points_in_box()));
  EXPECT_FALSE(flow.follow(1, 3, kMaskBox, points_in_box()));
  EXPECT_FALSE(flow.follow(1, 2, kMaskBox, {{300, 200}, {310, 210}}));
  EXPECT_FALSE(flow.follow(1, 2, kMaskBox, {}));
}

TEST(MaskFlow, remembers_a_bounded_number_of_images) {
  MaskFlow flow;
  const cv::Mat image = picture(0);
  for (std::int64_t i = 0; i < 40; ++i) flow.see(i, image);
  EXPECT_FALSE(flow.follow(2, 3, kMaskBox, points_in_box()));
  EXPECT_TRUE(flow.follow(38, 39, kMaskBox, points_in_box()));
  flow.see(5, image);
  EXPECT_FALSE(flow.follow(38, 39, kMaskBox, points_in_box())) << "time went back";
}

TEST(MotionOfPoints, is_not_misled_by_a_third_of_wrong_points) {
  const std::vector<cv::Point2f> from = points_in_box();
  std::vector<cv::Point2f> to;
  for (std::size_t i = 0; i < from.size(); ++i) {
    to.push_back(from[i] + (i % 3 == 0 ? cv::Point2f(0, 0) : cv::Point2f(8, -3)));
  }
  const auto flow = motion_of_points(kMaskBox, from, to);
  ASSERT_TRUE(flow);
  EXPECT_NEAR(flow->shift_px.x(), 8, 0.6) << "px";
  EXPECT_NEAR(flow->shift_px.y(), -3, 0.6) << "px";
}

}  // namespace
}  // namespace rtd::filter
