// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/core/tracking/pose_uncertainty.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;

/// The view of a frame in which a person leaves only the first `count` features.
std::unique_ptr<msg::FeatureFrame> crowded_view(const FeatureWorld& world, std::uint64_t seq, std::uint32_t count) {
  auto frame = world.view(seq);
  for (std::uint32_t i = count; i < frame->count; ++i) frame->features[i].flags = msg::kFeatureRemoved;
  return frame;
}

/// Position and rotation error in the world frame, as the covariance has them.
geometry::Vector6d error_of(const Eigen::Isometry3d& T_estimate, std::uint64_t seq) {
  const Eigen::Isometry3d T_truth = FeatureWorld::T_world_camera(seq);
  geometry::Vector6d error;
  error << T_estimate.translation() - T_truth.translation(),
      geometry::so3_log(T_estimate.linear() * T_truth.linear().transpose());
  return error;
}

geometry::Vector6d sigma_of(const FrameResult& result) {
  return result.covariance.diagonal().cwiseSqrt();
}

constexpr std::uint64_t kHoldFrames = 14;  // at 30 Hz the default half second

TEST(Prediction, bridges_half_a_second_and_marks_it) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam(test_support::settled(), MappingMode::kSynchronous, frozen_clock);
  std::uint64_t seq = 0;
  for (; seq < 30; ++seq) ASSERT_EQ(slam.process(*world.view(seq)).result.state, TrackingState::kOk);
  double sigma_before_m = 0;
  for (const std::uint64_t last = seq + kHoldFrames; seq < last; ++seq) {
    const SlamOutput output = slam.process(*crowded_view(world, seq, 0));
    ASSERT_EQ(output.result.state, TrackingState::kPredicted) << "frame " << seq;
    EXPECT_THAT(output.problem, ::testing::StartsWith("predicted"));
    EXPECT_GT(sigma_of(output.result)(0), sigma_before_m) << "frame " << seq;
    sigma_before_m = sigma_of(output.result)(0);
  }
  EXPECT_LT(sigma_before_m, 0.3);
  for (const std::uint64_t last = seq + 5; seq < last; ++seq) {
    const TrackingState state = slam.process(*crowded_view(world, seq, 0)).result.state;
    const bool surely_over = seq + 4 >= last;
    EXPECT_TRUE(state == TrackingState::kRecentlyLost || !surely_over) << "frame " << seq;
  }
  EXPECT_EQ(slam.frames_tracked(), 30U) << "a prediction went into the trajectory";
}

TEST(Prediction, error_stays_within_three_sigma) {
  int held = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const FeatureWorld world = FeatureWorld::noisy(seed);
    for (std::uint64_t start = 10; start < 90; start += 8) {
      SlamSystem slam(test_support::settled(), MappingMode::kSynchronous, frozen_clock);
      for (std::uint64_t seq = start - 8; seq < start; ++seq) slam.process(*world.view(seq));
      const Eigen::Isometry3d T_truth_world = FeatureWorld::T_world_camera(start - 8);
      for (std::uint64_t seq = start; seq < start + kHoldFrames; ++seq) {
        const SlamOutput output = slam.process(*crowded_view(world, seq, 0));
        ASSERT_EQ(output.result.state, TrackingState::kPredicted);
        // The map's world is the first camera.
        const Eigen::Isometry3d T_estimate = T_truth_world * output.result.T_world_camera;
        const Eigen::Matrix3d R = T_truth_world.linear().transpose();
        geometry::Vector6d error = error_of(T_estimate, seq);
        error << R * error.head<3>().eval(), R * error.tail<3>().eval();
        const geometry::Vector6d sigma = sigma_of(output.result);
        for (int axis = 0; axis < 6; ++axis) {
          EXPECT_LT(std::abs(error(axis)), 3 * sigma(axis)) << "axis " << axis << ", frame " << seq - start;
        }
        ++held;
      }
    }
  }
  EXPECT_EQ(held, 3 * 10 * static_cast<int>(kHoldFrames));
}

TEST(Prediction, tracking_continues_in_the_same_map) {
  for (const std::uint64_t gap : {4, 12, 40}) {
    const FeatureWorld world = FeatureWorld::noisy();
    SlamSystem slam(test_support::settled(), MappingMode::kSynchronous, frozen_clock);
    std::uint64_t seq = 0;
    for (; seq < 30; ++seq) slam.process(*world.view(seq));
    const std::uint32_t landmarks = slam.process(*crowded_view(world, seq++, 0)).result.landmarks;
    for (const std::uint64_t last = seq + gap; seq < last; ++seq) slam.process(*crowded_view(world, seq, 0));
    std::uint64_t frames_until_ok = 0;
    SlamOutput back = slam.process(*world.view(seq));
    while (back.result.state != TrackingState::kOk && frames_until_ok < 5) {
      back = slam.process(*world.view(++seq));
      ++frames_until_ok;
    }
    ASSERT_EQ(back.result.state, TrackingState::kOk) << "gap " << gap;
    EXPECT_LE(frames_until_ok, 2U);
    EXPECT_GE(back.result.landmarks, landmarks) << "a new map";
    EXPECT_LT(error_of(back.result.T_world_camera, seq).head<3>().norm(), 0.01) << "gap " << gap;
  }
}

TEST(Prediction, few_landmarks_are_better_than_none) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamConfig config = test_support::settled();
  config.sensor.calibration_error = 0;  // leaves what the landmarks say
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  std::uint64_t seq = 0;
  for (; seq < 30; ++seq) slam.process(*world.view(seq));
  int weak = 0;
  for (const std::uint64_t last = seq + kHoldFrames; seq < last; ++seq) {
    const SlamOutput output = slam.process(*crowded_view(world, seq, 20));  // with more, odometry
    ASSERT_EQ(output.result.state, TrackingState::kPredicted) << "frame " << seq << ", " << output.result.inliers;
    if (sigma_of(output.result)(0) > 0.01) continue;
    ++weak;
    EXPECT_LT(error_of(output.result.T_world_camera, seq).head<3>().norm(), 0.03) << "frame " << seq;
  }
  EXPECT_GT(weak, 1);
  EXPECT_EQ(slam.frames_tracked(), 30U);
}

TEST(CalibrationCovariance, grows_with_way_and_turn_from_the_origin) {
  constexpr double kFar_m = 3, kShare = 0.01, kTurn_rad = 0.5;
  EXPECT_TRUE(calibration_covariance(Eigen::Isometry3d::Identity(), kFar_m, kShare).isZero());
  Eigen::Isometry3d T_world_camera(Eigen::AngleAxisd(kTurn_rad, Eigen::Vector3d::UnitY()));
  T_world_camera.translation() = Eigen::Vector3d(0, 3, 4);
  const geometry::Vector6d sigma = calibration_covariance(T_world_camera, kFar_m, kShare).diagonal().cwiseSqrt();
  EXPECT_NEAR(sigma(0), std::hypot(0.05, 0.015), 1e-12);  // 1 % of 5 m, and of half a radian at 3 m
  EXPECT_NEAR(sigma(3), 0.005, 1e-12);
}

TEST(Prediction, can_be_switched_off) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamConfig config = test_support::settled();
  config.techniques.prediction = false;
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  for (std::uint64_t seq = 0; seq < 10; ++seq) slam.process(*world.view(seq));
  EXPECT_EQ(slam.process(*crowded_view(world, 10, 0)).result.state, TrackingState::kRecentlyLost);
}

TEST(Prediction, fades_to_rest_and_doubts_more_the_faster_it_was) {
  CameraMotion slow, fast;
  slow.velocity_per_s(0) = 0.1;
  fast.velocity_per_s(0) = 1.0;
  const PredictionConfig config;
  EXPECT_NEAR(predict_motion(fast, 100, config).T_world_camera.translation().x(), config.velocity_decay_s, 1e-9);
  EXPECT_NEAR(predict_motion(fast, 0.01, config).T_world_camera.translation().x(), 0.01, 2e-4);
  EXPECT_LT(predict_motion(slow, 0.3, config).covariance(0, 0), predict_motion(fast, 0.3, config).covariance(0, 0));
}

/// Frames are missing, or the camera was carried on: the way to there is no velocity to undo a rolling shutter with.
TEST(Prediction, jump_bends_no_frame) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamConfig config = test_support::settled();
  config.sensor.readout_s = 0.02;
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  for (std::uint64_t seq = 0; seq < 10; ++seq) slam.process(*world.view(seq, T_world_camera));
  T_world_camera.translation().x() += 0.15;
  for (std::uint64_t seq = 10; seq < 13; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq, T_world_camera));
    ASSERT_TRUE(msg::is_measured(output.result.state)) << "frame " << seq;
    const Eigen::Isometry3d T_estimate = output.result.T_world_camera;
    EXPECT_LT((T_estimate.translation() - T_world_camera.translation()).norm(), 0.003) << "frame " << seq;
  }
}

}  // namespace
}  // namespace rtd::slam
