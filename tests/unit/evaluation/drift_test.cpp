// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/integrity.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace rtd::eval {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPeriod_s = 1.0 / 30;

/// A camera at rest.
Trajectory at_rest(int frames) {
  Trajectory path;
  for (int i = 0; i < frames; ++i) path.push_back({std::llround(1e9 * i * kPeriod_s), Eigen::Isometry3d::Identity()});
  return path;
}

/// The estimate moves to the right, and turns so that what is at `wall_m` stays where it is in the image.
Trajectory traded(int frames, double speed_m_s, double wall_m) {
  Trajectory path = at_rest(frames);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double way_m = speed_m_s * kPeriod_s * static_cast<double>(i);
    path[i].T_world_body =
        Eigen::Translation3d(way_m, 0, 0) * Eigen::AngleAxisd(-std::atan2(way_m, wall_m), Eigen::Vector3d::UnitY());
  }
  return path;
}

TEST(Drift, of_a_pose_that_keeps_a_wall_in_place_has_its_depth_as_quotient) {
  const Drift drift = measure_drift(traded(40, 0.3, 3.7), at_rest(40));
  EXPECT_EQ(drift.windows, 29U);
  EXPECT_NEAR(drift.median_m, 0.1, 0.001);
  EXPECT_NEAR(drift.median_rad, 0.1 / 3.7, 0.001);
  EXPECT_NEAR(drift.quotient_m_per_rad, 3.7, 0.1);
  EXPECT_TRUE(drift.nearly_constant());
}

TEST(Drift, windows_within_three_centimetres_do_not_count) {
  EXPECT_EQ(measure_drift(traded(40, 0.0899, 3.7), at_rest(40)).windows, 0U);
  EXPECT_EQ(measure_drift(traded(40, 0.0905, 3.7), at_rest(40)).windows, 29U);
}

TEST(Drift, seven_windows_are_too_few_for_a_constant) {
  EXPECT_EQ(measure_drift(traded(18, 0.3, 3.7), at_rest(18)).windows, 7U);
  EXPECT_FALSE(measure_drift(traded(18, 0.3, 3.7), at_rest(18)).nearly_constant());
  EXPECT_TRUE(measure_drift(traded(19, 0.3, 3.7), at_rest(19)).nearly_constant());
}

TEST(Drift, quartiles_beyond_fifteen_percent_are_no_constant) {
  const auto drift = [](double lower, double upper) { return Drift{20, 0.1, 0.03, 2, lower, upper}; };
  EXPECT_TRUE(drift(1.71, 2.29).nearly_constant());
  EXPECT_FALSE(drift(1.69, 2.29).nearly_constant());
  EXPECT_FALSE(drift(1.71, 2.31).nearly_constant());
}

TEST(Drift, without_a_turn_has_a_huge_quotient_and_without_windows_none) {
  Trajectory sideways = at_rest(30);
  for (std::size_t i = 0; i < sideways.size(); ++i)
    sideways[i].T_world_body.translation().x() = 0.01 * static_cast<double>(i);
  EXPECT_GT(measure_drift(sideways, at_rest(30)).quotient_m_per_rad, 1e4);
  const Drift none = measure_drift(at_rest(30), at_rest(30));
  EXPECT_TRUE(std::isnan(none.quotient_m_per_rad));
  EXPECT_FALSE(none.nearly_constant());
}

TEST(Drift, is_explained_where_it_is_constant_and_compared_with_the_scene) {
  const Drift constant{20, 0.1, 0.027, 3.7, 3.5, 3.9}, scattered{20, 0.1, 0.027, 3.7, 1, 9};
  EXPECT_THAT(explain(scattered), IsEmpty());
  EXPECT_THAT(explain(constant), AllOf(testing::StartsWith("0."), HasSubstr("keeps what is 3.7 m away in place"),
                                       HasSubstr("nearer than that")));
  EXPECT_THAT(explain(constant, 4.0), HasSubstr("the scene's depth is 4.0 m, near that"));
  EXPECT_THAT(explain(constant, 2.0), HasSubstr("not near that"));
}

TEST(Drift, figures_name_metres_degrees_and_quotient) {
  const auto figures = drift_figures({20, 0.1, 0.027, 3.7, 3.5, 3.9}, std::nullopt);
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_THAT(figures[0].second, AllOf(HasSubstr("0.100 m"), HasSubstr("1.55 deg"), HasSubstr("20 windows")));
  EXPECT_THAT(figures[1].second, HasSubstr("3.70 m/rad (quartiles 3.50 and 3.90)"));
  EXPECT_THAT(drift_figures({}, std::nullopt)[0].second, HasSubstr("at most 3 cm"));
}

}  // namespace
}  // namespace rtd::eval
