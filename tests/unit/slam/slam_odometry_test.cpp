// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>

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

}  // namespace
}  // namespace rtd::slam
