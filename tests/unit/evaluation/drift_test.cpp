// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "common/geometry/se3.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"
#include "tests/unit/evaluation/eval_paths.hpp"

namespace rtd::eval {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::moved;
using testing_support::some_transform;
using testing_support::winding_path;

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

/// What a camera that is `T_body_camera` in the body of a trajectory does.
Trajectory camera_of(const Trajectory& body, const Eigen::Isometry3d& T_body_camera) {
  return camera_truth(body, BodyOffset{T_body_camera});
}

Eigen::Isometry3d markers() {
  return Eigen::Translation3d(0.03, -0.05, 0.1) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, -1).normalized());
}

/// 1 mm and 1 mrad, another at each pose.
void disturb(Trajectory& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double phase = static_cast<double>(i * i);
    geometry::Vector6d error;
    error << std::sin(phase), std::cos(phase), std::sin(2 * phase), std::cos(3 * phase), std::sin(5 * phase), 0;
    poses[i].T_world_body = poses[i].T_world_body * geometry::se3_exp(1e-3 * error);
  }
}

TEST(BodyOffset, is_found_by_the_motions_of_both) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = moved(camera_of(body, markers()), some_transform());
  disturb(camera);
  const auto offset = find_body_offset(camera, body, 0);
  ASSERT_TRUE(offset.has_value());
  const Eigen::Isometry3d T_error = markers().inverse() * offset->T_body_camera;
  EXPECT_LT(geometry::rotation_angle_rad(T_error), 0.01);
  EXPECT_LT(T_error.translation().norm(), 0.01);
  EXPECT_FALSE(offset->of_bonn);
}

TEST(BodyOffset, is_found_although_the_estimate_jumps_for_a_fifth_of_the_time) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = camera_of(body, markers());
  disturb(camera);
  for (std::size_t i = 60; i < 100; ++i) camera[i].T_world_body = some_transform() * camera[i].T_world_body;
  const auto offset = find_body_offset(camera, body, 0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_LT(geometry::rotation_angle_rad(markers().inverse() * offset->T_body_camera), 0.01);
}

TEST(BodyOffset, a_lever_arm_alone_is_found) {
  const Trajectory body = winding_path(200, 0.1);
  const Eigen::Isometry3d arm(Eigen::Translation3d(0.4, 0, 0.2));
  Trajectory camera = camera_of(body, arm);
  disturb(camera);
  const auto offset = find_body_offset(camera, body, 0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_LT((offset->T_body_camera.translation() - arm.translation()).norm(), 0.02);
}

TEST(BodyOffset, the_body_of_bonn_is_known_by_its_turn) {
  Eigen::Matrix3d rows;
  rows << -0.9589, -0.1726, 0.2255, -0.2841, 0.5803, -0.7633, 0.0008, -0.7959, -0.6054;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(rows).normalized().toRotationMatrix();
  const Trajectory body = winding_path(200, 0.1);
  const auto offset = find_body_offset(camera_of(body, T), body, 0);
  ASSERT_TRUE(offset.has_value());
  EXPECT_TRUE(offset->of_bonn);
}

TEST(BodyOffset, there_is_none_of_the_same_body) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = moved(body, some_transform());
  disturb(camera);
  EXPECT_FALSE(find_body_offset(camera, body, 0).has_value());
}

TEST(BodyOffset, a_bad_estimate_is_not_explained_by_one) {
  const Trajectory body = winding_path(200, 0.1);
  Trajectory camera = body;
  for (std::size_t i = 0; i < camera.size(); ++i)
    camera[i].T_world_body.translation() += 0.3 * Eigen::Vector3d(std::sin(0.9 * static_cast<double>(i)), 0, 0);
  EXPECT_FALSE(find_body_offset(camera, body, 0).has_value());
}

TEST(BodyOffset, turns_about_one_axis_alone_show_none) {
  Trajectory body = winding_path(200, 0.1);
  for (StampedPose& pose : body) {
    const double s = static_cast<double>(pose.stamp_ns) * 1e-9;
    pose.T_world_body.linear() = Eigen::AngleAxisd(0.3 * s, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  EXPECT_FALSE(find_body_offset(camera_of(body, markers()), body, 0).has_value());
}

TEST(BodyOffset, relative_errors_are_those_of_the_camera_and_the_ate_is_of_the_positions_as_they_are) {
  const Trajectory body = winding_path(200, 0.1);
  const Trajectory camera = moved(camera_of(body, markers()), some_transform());
  const Evaluation evaluation = evaluate(camera, body);
  EXPECT_NEAR(evaluation.rpe_per_second.rotation_rad.rmse, 0, 1e-6);
  EXPECT_NEAR(evaluation.rpe_per_second.translation_m.rmse, 0, 1e-6);
  EXPECT_EQ(evaluation.ate.error_m.rmse, ate(camera, body).error_m.rmse);
  EXPECT_GT(evaluation.ate.error_m.rmse, 0.001);
}

}  // namespace
}  // namespace rtd::eval
