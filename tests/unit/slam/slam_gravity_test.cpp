// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;

/// A view of the world, with a floor 1 m below the first camera whose normal this is.
std::unique_ptr<msg::FeatureFrame> view_with_floor(std::uint64_t seq, const Eigen::Vector3d& up_world) {
  auto frame = FeatureWorld({.points = 600}).view(seq);
  const Eigen::Isometry3d T_camera_world = FeatureWorld::T_world_camera(seq).inverse();
  const auto is_below = [&](const msg::Feature& feature) {
    const double z = static_cast<double>(feature.depth_m);
    const Eigen::Vector3d p_camera((static_cast<double>(feature.u_px) - FeatureWorld::kCx) / FeatureWorld::kFx * z,
                                   (static_cast<double>(feature.v_px) - FeatureWorld::kCy) / FeatureWorld::kFy * z, z);
    return up_world.dot(FeatureWorld::T_world_camera(seq) * p_camera) < -1;
  };
  const auto end = frame->features.begin() + frame->count;
  frame->count =
      static_cast<std::uint32_t>(std::remove_if(frame->features.begin(), end, is_below) - frame->features.begin());
  std::mt19937_64 points(3), random(seq);
  for (int i = 0; i < 200; ++i) {
    const auto between = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(points() % 10'000) / 10'000;
    };
    Eigen::Vector3d p(between(-1, 1), 0, between(1.8, 3.5));
    p.y() = -(1 + up_world.x() * p.x() + up_world.z() * p.z()) / up_world.y();  // up_world . p = -1
    msg::Descriptor descriptor;
    for (auto& word : descriptor) word = static_cast<std::remove_reference_t<decltype(word)>>(points());
    const Eigen::Vector3d p_camera = T_camera_world * p;
    const double u = FeatureWorld::kFx * p_camera.x() / p_camera.z() + FeatureWorld::kCx;
    const double v = FeatureWorld::kFy * p_camera.y() / p_camera.z() + FeatureWorld::kCy;
    if (u < 1 || v < 1 || u > FeatureWorld::kWidth - 2 || v > FeatureWorld::kHeight - 2) continue;
    test_support::add_feature(*frame, {u, v, p_camera.z(), 0, 0}, descriptor, 0, random);
  }
  return frame;
}

/// Of a camera that looks horizontally, in a world with z up.
const Eigen::Isometry3d kLevelCamera(Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5));

Eigen::Vector3d up_in_camera(const Eigen::Isometry3d& T_world_camera) {
  return T_world_camera.linear().transpose() * Eigen::Vector3d::UnitZ();
}

SlamSystem slam_with(Gravity gravity, int wait_frames = 3) {
  SlamConfig config = test_support::settled();
  config.first_pose = kLevelCamera;
  config.gravity = gravity;
  config.prior.imu = gravity == Gravity::kImu;
  config.gravity_wait_frames = wait_frames;
  return {config, MappingMode::kSynchronous, frozen_clock};
}

TEST(SlamGravity, a_map_begins_upright_when_the_floor_is_seen) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.15, -1, -0.3).normalized();
  SlamSystem slam = slam_with(Gravity::kFloor);
  for (std::uint64_t seq = 0; seq < 10; ++seq) {
    const SlamOutput output = slam.process(*view_with_floor(seq, up));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << output.problem;
    const Eigen::Vector3d expected = FeatureWorld::T_world_camera(seq).linear().transpose() * up;
    EXPECT_LT((up_in_camera(output.result.T_world_camera) - expected).norm(), 0.005) << "rad, frame " << seq;
    EXPECT_TRUE(output.T_map_odom.isApprox(Eigen::Isometry3d::Identity(), 1e-9)) << "odom begins where map does";
    EXPECT_EQ(output.up.has_value(), seq == 0);
    if (!output.up) continue;
    EXPECT_TRUE(output.up->found);
    EXPECT_NEAR(output.up->turned_rad, std::acos(-up.y()), 0.005);
    EXPECT_NEAR(output.up->height_m, 1, 0.01);
    EXPECT_LT(output.result.T_world_camera.translation().norm(), 1e-9) << "turned about its origin";
  }
}

TEST(SlamGravity, a_map_begins_level_when_no_floor_has_come_into_view) {
  const FeatureWorld world({});
  SlamSystem slam = slam_with(Gravity::kFloor, 3);
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    EXPECT_EQ(output.result.state, TrackingState::kInitializing);
    EXPECT_NE(output.problem.find("up"), std::string::npos) << output.problem;
    EXPECT_FALSE(output.up);
  }
  const SlamOutput output = slam.process(*world.view(3));
  EXPECT_EQ(output.result.state, TrackingState::kOk);
  ASSERT_TRUE(output.up);
  EXPECT_FALSE(output.up->found);
  EXPECT_EQ(output.up->frames, 3);
  EXPECT_TRUE(output.result.T_world_camera.isApprox(kLevelCamera, 1e-12));
}

TEST(SlamGravity, a_map_waits_for_an_imu_at_rest_that_knows_what_is_up) {
  const FeatureWorld world({});
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -1, 0.2).normalized();
  SlamSystem slam = slam_with(Gravity::kImu);
  EXPECT_EQ(slam.process(*world.view(0)).result.state, TrackingState::kInitializing);
  for (std::int64_t i = 0; i <= 120; ++i)
    slam.add(
        inertial::ImuSample{FeatureWorld::stamp_ns(1) + (i - 120) * 5'000'000, Eigen::Vector3d::Zero(), 9.81 * up});
  const SlamOutput output = slam.process(*world.view(1));
  EXPECT_EQ(output.result.state, TrackingState::kOk);
  EXPECT_LT((up_in_camera(output.result.T_world_camera) - up).norm(), 1e-9);
}

TEST(SlamGravity, after_a_reset_the_next_map_is_upright_again_and_the_odometry_continues) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.15, -1, -0.3).normalized();
  SlamSystem slam = slam_with(Gravity::kFloor);
  const auto in_odom = [](const SlamOutput& output) {
    return output.T_map_odom.inverse() * output.result.T_world_camera;
  };
  SlamOutput before;
  for (std::uint64_t seq = 0; seq < 5; ++seq) before = slam.process(*view_with_floor(seq, up));
  slam.reset();
  const SlamOutput after = slam.process(*view_with_floor(5, up));
  const Eigen::Vector3d expected = FeatureWorld::T_world_camera(5).linear().transpose() * up;
  EXPECT_LT((up_in_camera(after.result.T_world_camera) - expected).norm(), 0.005);
  EXPECT_TRUE(in_odom(after).isApprox(in_odom(before), 0.05));
}

}  // namespace
}  // namespace rtd::slam
