// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/unit/slam/slam_run.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test::make_slam;
using test::position_error_m;
using test_support::FeatureWorld;
using test_support::frozen_clock;

class SlamOdometry : public testing::Test {
 protected:
  const FeatureWorld world_{{}};
  SlamSystem slam_ = make_slam();
};

/// Of a view, some features of the world; the others look like nothing before.
std::unique_ptr<msg::FeatureFrame> mostly_hidden(const FeatureWorld& world, std::uint64_t seq,
                                                 std::uint32_t shown = 70) {
  auto frame = world.view(seq);
  const auto other = FeatureWorld({.seed = 100}).view(seq);
  for (std::uint32_t i = shown; i < frame->count; ++i) {
    frame->features[i].descriptor = other->features[i % other->count].descriptor;
  }
  return frame;
}

TEST_F(SlamOdometry, few_landmarks_suffice_where_the_motion_leads) {
  constexpr std::uint64_t kSeen = 20;
  for (std::uint64_t seq = 0; seq < kSeen; ++seq) slam_.process(*world_.view(seq));
  const SlamOutput expected = slam_.process(*mostly_hidden(world_, kSeen));
  EXPECT_EQ(expected.result.state, TrackingState::kOk) << expected.problem;
  EXPECT_LE(expected.result.inliers, 80U);
  EXPECT_LT(position_error_m(expected.result.T_world_camera, kSeen), 0.01);
}

TEST_F(SlamOdometry, continues_from_frame_to_frame_without_the_map) {
  slam_.process(*world_.view(0));
  const SlamOutput few = slam_.process(*mostly_hidden(world_, 1, 26));
  ASSERT_EQ(few.result.state, TrackingState::kOdometry) << few.problem;
  EXPECT_THAT(few.problem, testing::HasSubstr("the map is not recognised"));
  EXPECT_LT(position_error_m(few.result.T_world_camera, 1), 0.02);
  EXPECT_EQ(slam_.keyframes().size(), 2U) << "a young map grows at once";
  const SlamOutput back = slam_.process(*world_.view(2));
  EXPECT_EQ(back.result.state, TrackingState::kOk) << back.problem;
  EXPECT_EQ(slam_.maps().size(), 1U);
  EXPECT_EQ(slam_.trajectory().size(), 3U) << "one trajectory";
}

/// A map of at least 20 keyframes, which odometry leaves as it is.
SlamSystem make_slam_that_maps_densely(double new_map_after_s) {
  SlamConfig config = test_support::settled();
  config.sensor.calibration_error = 0;
  config.keyframe.min_gap_s = 0;
  config.keyframe.reference_ratio = 1;
  config.mapper.redundant_ratio = config.mapper.old_redundant_ratio = 1;
  config.place.new_map_after_s = new_map_after_s;
  return {config, MappingMode::kSynchronous, frozen_clock};
}

/// Returns the next frame.
std::uint64_t map_until_old(SlamSystem& slam, const FeatureWorld& world) {
  std::uint64_t seq = 0;
  while (slam.keyframes().size() < 22 && seq < 300) slam.process(*world.view(seq++));
  EXPECT_GE(slam.keyframes().size(), 22U);
  return seq;
}

TEST(SlamOdometries, odometry_continues_beside_an_old_map_and_joins_it_again) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam_that_maps_densely(3);
  constexpr std::uint64_t kLost = 15;
  const std::uint64_t seen = map_until_old(slam, world);
  const std::size_t keyframes = slam.keyframes().size();
  double variance_m2 = 0;
  std::uint64_t seq = seen;
  for (; seq < seen + kLost; ++seq) {
    const SlamOutput output = slam.process(*mostly_hidden(world, seq, 26));
    ASSERT_EQ(output.result.state, TrackingState::kOdometry) << "frame " << seq << ": " << output.problem;
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 0.05) << "frame " << seq;
    EXPECT_GT(output.result.covariance.trace(), variance_m2) << "frame " << seq;
    variance_m2 = output.result.covariance.trace();
  }
  EXPECT_EQ(slam.keyframes().size(), keyframes) << "an old map does not grow by what is not recognised";
  const SlamOutput back = slam.process(*world.view(seq));
  EXPECT_EQ(back.result.state, TrackingState::kOk) << back.problem;
  EXPECT_LT(position_error_m(back.result.T_world_camera, seq), 0.01);
  const std::vector<StampedPose> trajectory = slam.trajectory();
  ASSERT_EQ(trajectory.size(), seq + 1) << "one trajectory";
  for (std::uint64_t i = seen; i < seen + kLost; ++i)
    EXPECT_LT(position_error_m(trajectory[i].T_world_body, i), 0.02) << "mended frame " << i;
}

TEST(SlamOdometries, an_old_map_grows_at_the_pose_of_lasting_odometry) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam_that_maps_densely(0.29);
  const std::uint64_t seen = map_until_old(slam, world);
  const std::size_t keyframes = slam.keyframes().size();
  std::uint64_t seq = seen;
  for (; seq < seen + 15 && slam.keyframes().size() == keyframes; ++seq) {
    const SlamOutput output = slam.process(*mostly_hidden(world, seq, 26));
    ASSERT_TRUE(msg::is_measured(output.result.state)) << "frame " << seq << ": " << output.problem;
  }
  EXPECT_EQ(seq, seen + 10) << "not before";
  EXPECT_EQ(slam.maps().size(), 1U) << "a second map is the last resort";
  slam.read_map([](const Map& map) {
    EXPECT_EQ(map.check_invariants(), "");
    EXPECT_TRUE(std::prev(map.keyframes().end())->second.covisible.empty()) << "nothing bends the old part";
  });
  EXPECT_EQ(slam.trajectory().size(), seq) << "one trajectory";
}

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
