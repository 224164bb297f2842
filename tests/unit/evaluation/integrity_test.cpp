// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/msg/transform_eigen.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"
#include "tests/unit/evaluation/eval_paths.hpp"

namespace rtd::eval {
namespace {

using msg::TrackingState;
using testing_support::some_transform;

constexpr int kFrames = 60;  // at 20 Hz: three seconds

Trajectory walk() {
  return testing_support::winding_path(kFrames, 0.05);
}

geometry::Matrix6d covariance(double variance) {
  return variance * geometry::Matrix6d::Identity();
}

/// What a tracker without error publishes, in a world of its own.
std::vector<PublishedPose> perfect(const Trajectory& truth, const Eigen::Isometry3d& T_own_world) {
  std::vector<PublishedPose> published;
  for (const StampedPose& pose : truth)
    published.push_back({pose.stamp_ns, TrackingState::kOk, T_own_world * pose.T_world_body, covariance(1e-4), 0});
  return published;
}

/// Moves the poses from `first` on to the side, in the axes of the camera.
void shift(std::vector<PublishedPose>& published, std::size_t first, double shift_m) {
  for (std::size_t i = first; i < published.size(); ++i)
    published[i].T_world_camera = published[i].T_world_camera * Eigen::Translation3d(shift_m, 0, 0);
}

void turn(std::vector<PublishedPose>& published, std::size_t first, double turn_deg) {
  for (std::size_t i = first; i < published.size(); ++i)
    published[i].T_world_camera =
        published[i].T_world_camera * Eigen::AngleAxisd(turn_deg / kRadToDeg, Eigen::Vector3d::UnitY());
}

void set_state(std::vector<PublishedPose>& published, std::size_t first, std::size_t end, TrackingState state) {
  for (std::size_t i = first; i < end; ++i) published[i].state = state;
}

TEST(Integrity, of_perfect_poses_in_another_world_has_no_fault) {
  const Trajectory truth = walk();
  const Integrity integrity = judge_integrity(perfect(truth, some_transform()), truth);
  EXPECT_EQ(integrity.frames, 60U);
  EXPECT_EQ(integrity.judged, 59U);  // the first pose has none before it
  EXPECT_EQ(integrity.good, 59U);
  EXPECT_EQ(integrity.dangerous, 0U);
  EXPECT_EQ(integrity.episodes, 0U);
  EXPECT_TRUE(std::isnan(integrity.delay_s_max));
  EXPECT_NEAR(integrity.nees_ok, 0, 1e-9);
  EXPECT_EQ(integrity.nees_frames, 55U);
}

class IntegrityTest : public testing::Test {
 protected:
  const Trajectory truth = walk();
  std::vector<PublishedPose> published = perfect(truth, some_transform());
};

TEST_F(IntegrityTest, counts_frames_within_a_second_of_a_step_beyond_five_centimetres) {
  shift(published, 30, 0.0501);
  EXPECT_EQ(judge_integrity(published, truth).dangerous, 20U);  // 20 Hz: after a second both poses have the shift
  shift(published, 30, -0.0002);
  EXPECT_EQ(judge_integrity(published, truth).dangerous, 0U);
}

TEST(Integrity, counts_frames_within_a_second_of_a_turn_beyond_three_degrees) {
  const Trajectory truth = walk();
  std::vector<PublishedPose> published = perfect(truth, Eigen::Isometry3d::Identity());
  turn(published, 30, 3.01);
  EXPECT_EQ(judge_integrity(published, truth, {.max_error_m = 1}).dangerous, 20U);
  turn(published, 30, -0.02);
  EXPECT_EQ(judge_integrity(published, truth, {.max_error_m = 1}).dangerous, 0U);
}

TEST_F(IntegrityTest, a_wrong_pose_that_is_not_ok_is_no_danger) {
  shift(published, 30, 0.07);
  set_state(published, 30, 50, TrackingState::kDoubtful);
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.dangerous, 0U);
  EXPECT_EQ(integrity.delay_s_max, 0);
  EXPECT_EQ(integrity.episodes, 1U);
}

TEST_F(IntegrityTest, a_pose_that_returns_from_doubt_to_its_place_is_named_so) {
  shift(published, 20, 0.2);
  shift(published, 30, -0.2);
  set_state(published, 20, 30, TrackingState::kDoubtful);
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.dangerous, 10U);  // frames 40 to 49 look back at those that were wrong
  EXPECT_EQ(integrity.returning, 10U);
}

TEST_F(IntegrityTest, the_wait_of_a_start_is_no_needless_doubt) {
  set_state(published, 0, 20, TrackingState::kDoubtful);
  set_state(published, 40, 41, TrackingState::kDoubtful);
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.good, 40U);
  EXPECT_EQ(integrity.needless, 1U);
}

TEST_F(IntegrityTest, doubt_is_needless_where_the_error_is_below_a_centimetre) {
  set_state(published, 40, 43, TrackingState::kDoubtful);
  Integrity integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.needless, 3U);
  EXPECT_DOUBLE_EQ(integrity.needless_doubt_share(), 3.0 / 59);
  shift(published, 40, 0.0101);
  integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.needless, 0U);
  EXPECT_EQ(integrity.good, 39U);
}

TEST_F(IntegrityTest, delay_is_the_time_from_the_error_to_the_doubt) {
  shift(published, 20, 0.06);
  set_state(published, 26, 45, TrackingState::kDoubtful);
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_NEAR(integrity.delay_s_max, 6 * 0.05, 1e-9);
  EXPECT_EQ(integrity.unnoticed, 0U);
  EXPECT_EQ(integrity.dangerous, 6U);
}

TEST_F(IntegrityTest, delay_of_an_error_that_is_never_doubted_is_its_length) {
  shift(published, 20, 0.06);
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.episodes, 1U);
  EXPECT_EQ(integrity.unnoticed, 1U);
  EXPECT_NEAR(integrity.delay_s_max, 1, 1e-9);
}

TEST_F(IntegrityTest, an_error_at_the_last_frame_ends_with_the_run) {
  shift(published, 59, 0.06);
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.unnoticed, 1U);
  EXPECT_EQ(integrity.delay_s_max, 0);
}

TEST_F(IntegrityTest, a_wrong_place_after_a_long_loss_is_compared_with_the_last_pose_before) {
  set_state(published, 10, 50, TrackingState::kLost);
  shift(published, 50, 0.5);
  const auto errors = errors_over_span(published, truth, 1);
  EXPECT_FALSE(errors[30].has_value());
  ASSERT_TRUE(errors[50].has_value());
  EXPECT_EQ(errors[50]->since, 9U);
  EXPECT_NEAR(errors[50]->translation_m, 0.5, 1e-9);
  EXPECT_EQ(judge_integrity(published, truth).dangerous, 10U);
}

TEST_F(IntegrityTest, poses_of_another_map_are_not_compared) {
  for (std::size_t i = 30; i < published.size(); ++i) {
    published[i].T_world_camera = some_transform() * published[i].T_world_camera;
    published[i].map_id = 1;
  }
  EXPECT_EQ(judge_integrity(published, truth).dangerous, 0U);
}

TEST(Integrity, nees_is_six_where_the_error_is_as_large_as_the_covariance_says) {
  const Trajectory truth = walk();
  std::vector<PublishedPose> published = perfect(truth, Eigen::Isometry3d::Identity());
  for (std::size_t i = 1; i < published.size(); ++i) {
    Eigen::Isometry3d& T = published[i].T_world_camera;
    T.translation() += Eigen::Vector3d::Constant(0.01);
    T.linear() = geometry::so3_exp(Eigen::Vector3d::Constant(0.01)) * T.linear();
  }
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_NEAR(integrity.nees_ok, 6, 1e-6);
  EXPECT_NEAR(integrity.nees_ok_median, 6, 1e-6);
}

TEST(Integrity, nees_leaves_doubtful_frames_and_unknown_covariances_out) {
  const Trajectory truth = walk();
  std::vector<PublishedPose> published = perfect(truth, Eigen::Isometry3d::Identity());
  set_state(published, 30, 40, TrackingState::kDoubtful);
  for (std::size_t i = 40; i < 50; ++i) published[i].covariance.reset();
  EXPECT_EQ(judge_integrity(published, truth).nees_frames, 35U);
}

TEST(Integrity, covariance_follows_when_it_is_larger_than_before_the_doubt) {
  const Trajectory truth = walk();
  std::vector<PublishedPose> published = perfect(truth, Eigen::Isometry3d::Identity());
  set_state(published, 20, 25, TrackingState::kDoubtful);
  set_state(published, 40, 45, TrackingState::kDoubtful);
  set_state(published, 50, 55, TrackingState::kPredicted);
  for (std::size_t i = 20; i < 25; ++i) published[i].covariance = covariance(4e-4);
  for (std::size_t i = 50; i < 55; ++i) published[i].covariance = covariance(9e-4);
  const Integrity integrity = judge_integrity(published, truth);
  EXPECT_EQ(integrity.doubtful.spans, 2U);
  EXPECT_EQ(integrity.doubtful.grown, 1U);
  EXPECT_NEAR(integrity.doubtful.median_ratio, 2.5, 1e-9);
  EXPECT_EQ(integrity.predicted.grown, 1U);
  EXPECT_NEAR(integrity.predicted.median_ratio, 9, 1e-9);
}

TEST(Integrity, without_frames_or_ground_truth_nothing_is_known) {
  EXPECT_TRUE(std::isnan(judge_integrity({}, walk()).dangerous_share()));
  const Integrity integrity = judge_integrity(perfect(walk(), some_transform()), {});
  EXPECT_EQ(integrity.judged, 0U);
  EXPECT_TRUE(std::isnan(integrity.needless_doubt_share()));
  EXPECT_TRUE(std::isnan(integrity.nees_ok));
}

TEST(Integrity, json_names_every_state_and_figure) {
  const auto json = to_json(judge_integrity(perfect(walk(), some_transform()), walk()));
  EXPECT_EQ(json.at("states").at("ok"), 60);
  EXPECT_EQ(json.at("states").at("lost"), 0);
  EXPECT_EQ(json.at("dangerous_share"), 0);
  for (const char* key : {"needless_doubt_share", "delay_s_max", "nees_ok", "covariance_doubtful"})
    EXPECT_TRUE(json.contains(key)) << key;
}

msg::TrackingResult result_at(std::int64_t stamp_ns, msg::TrackingState state) {
  msg::TrackingResult result{};
  result.stamp_ns = stamp_ns;
  result.state = state;
  result.T_world_camera = msg::to_message(Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3)));
  for (std::size_t i = 0; i < 6; ++i) result.covariance[7 * i] = 0.01;
  return result;
}

TEST(PublishedPose, has_pose_covariance_state_and_map_of_the_result) {
  msg::TrackingResult result = result_at(5, msg::TrackingState::kDoubtful);
  result.map_id = 2;
  const PublishedPose pose = published_pose(result);
  EXPECT_EQ(pose.stamp_ns, 5);
  EXPECT_EQ(pose.state, msg::TrackingState::kDoubtful);
  EXPECT_EQ(pose.map_id, 2U);
  EXPECT_EQ(pose.T_world_camera.translation(), Eigen::Vector3d(1, 2, 3));
  ASSERT_TRUE(pose.covariance.has_value());
  EXPECT_NEAR(pose.covariance->trace(), 0.06, 1e-12);
}

TEST(PublishedPose, covariance_of_zeros_or_of_the_unknown_is_none) {
  msg::TrackingResult result = result_at(5, msg::TrackingState::kOk);
  result.covariance.fill(0);
  EXPECT_FALSE(published_pose(result).covariance.has_value());
  for (std::size_t i = 0; i < 6; ++i) result.covariance[7 * i] = 1e6;
  EXPECT_FALSE(published_pose(result).covariance.has_value());
  result.covariance[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(published_pose(result).covariance.has_value());
}

TEST(PublishedPose, broken_poses_and_unknown_states_are_lost_frames) {
  msg::TrackingResult result = result_at(5, msg::TrackingState::kOk);
  result.T_world_camera.rotation_xyzw = {};
  EXPECT_EQ(published_pose(result).state, msg::TrackingState::kLost);
  EXPECT_EQ(published_pose(result_at(5, static_cast<msg::TrackingState>(77))).state, msg::TrackingState::kLost);
}

TEST(PublishedPose, measured_ones_of_the_first_map_make_a_trajectory) {
  std::vector<PublishedPose> published;
  for (const auto state : {msg::TrackingState::kOk, msg::TrackingState::kPredicted, msg::TrackingState::kDoubtful,
                           msg::TrackingState::kLost, msg::TrackingState::kOk})
    published.push_back(published_pose(result_at(static_cast<std::int64_t>(published.size()), state)));
  published.back().map_id = 1;
  const geometry::Trajectory poses = measured_poses(published);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].stamp_ns, 2);
}

}  // namespace
}  // namespace rtd::eval
