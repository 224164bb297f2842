// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "tests/unit/slam/slam_run.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test::make_slam;
using test::position_error_m;
using test_support::FeatureWorld;
using test_support::frozen_clock;

constexpr std::uint64_t kFrames = 90;

std::unique_ptr<msg::FeatureFrame> empty_view(std::uint64_t seq) {
  auto frame = FeatureWorld({}).view(seq, Eigen::Isometry3d::Identity());
  frame->count = 0;
  return frame;
}

class SlamSystemTest : public testing::Test {
 protected:
  const FeatureWorld world_{{}};
  SlamSystem slam_ = make_slam();
};

TEST_F(SlamSystemTest, follows_the_camera_through_an_exact_world) {
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam_.process(*world_.view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << "frame " << seq << ": " << output.problem;
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 1e-3) << "frame " << seq;
  }
}

TEST_F(SlamSystemTest, refuses_images_and_cameras_that_cannot_be) {
  constexpr std::uint32_t kMax = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t seq = 0;
  for (const auto& [width, height] : {std::pair(kMax, kMax), {0x7FFFFFFFU, 1U}, {1U, 0x80000000U}, {1921U, 10U}}) {
    const auto frame = world_.view(seq++);
    frame->width = width;
    frame->height = height;
    EXPECT_THAT(slam_.process(*frame).problem, testing::HasSubstr("image size")) << width << "x" << height;
  }
  for (const double focal_px : {1e300, 1e-300, std::nan("")}) {
    const auto frame = world_.view(seq++);
    frame->intrinsics[0] = focal_px;
    EXPECT_THAT(slam_.process(*frame).problem, testing::HasSubstr("intrinsics")) << focal_px;
  }
  EXPECT_EQ(slam_.process(*world_.view(seq)).result.state, TrackingState::kOk) << "continues with good ones";
}

TEST_F(SlamSystemTest, follows_stamps_that_jump_to_the_ends_of_time) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max(),
                         kMin = std::numeric_limits<std::int64_t>::min();
  const std::array<std::int64_t, 8> stamps{0, kMax, kMin, 0, kMin + 1, kMax - 1, -4'000'000'000'000'000'000, kMax};
  for (std::uint64_t seq = 0; seq < 5 * stamps.size(); ++seq) {
    const auto frame = world_.view(seq);
    frame->stamp_ns = stamps[seq % stamps.size()];
    EXPECT_TRUE(slam_.process(*frame).result.T_world_camera.matrix().allFinite()) << seq;
  }
}

TEST(SlamSystems, the_first_pose_says_where_the_world_is) {
  const FeatureWorld world({});
  SlamConfig config = test_support::settled();
  config.first_pose = geometry::se3_exp((geometry::Vector6d() << 0.2, 0, 0.5, -1.2, 1.2, -1.2).finished());
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  SlamSystem usual(test_support::settled(), MappingMode::kSynchronous, frozen_clock);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << "frame " << seq << ": " << output.problem;
    const Eigen::Isometry3d expected = config.first_pose * FeatureWorld::T_world_camera(seq);
    EXPECT_TRUE(output.result.T_world_camera.isApprox(expected, 2e-3)) << "frame " << seq;
    EXPECT_TRUE(output.T_map_odom.isApprox(Eigen::Isometry3d::Identity(), 1e-9)) << "odom begins where map does";
    const double trace = usual.process(*world.view(seq)).result.covariance.trace();
    EXPECT_NEAR(output.result.covariance.trace(), trace, 0.1 * trace) << "frame " << seq;
  }
  slam.reset();
  const SlamOutput again = slam.process(*world.view(0));
  EXPECT_TRUE(again.result.T_world_camera.isApprox(config.first_pose, 1e-9)) << "also after a reset";
}

TEST(SlamSystems, stays_within_a_centimetre_with_noise) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam();
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk);
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 0.01) << "frame " << seq;
    if (seq == 0) continue;
    const geometry::Matrix6d& covariance = output.result.covariance;
    const double sigma_m = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    EXPECT_GT(sigma_m, 1e-5);
    EXPECT_LT(sigma_m, 0.01);
  }
  slam.finish();
  EXPECT_EQ(slam.trajectory().size(), kFrames);
  EXPECT_GE(slam.keyframes().size(), 2U);
  EXPECT_GT(slam.map_points().size(), 300U);
}

TEST(SlamSystems, gives_the_same_bits_twice) {
  const FeatureWorld world = FeatureWorld::noisy();
  std::array<std::string, 2> texts;
  for (std::string& text : texts) {
    SlamSystem slam = make_slam();
    for (std::uint64_t seq = 0; seq < kFrames; ++seq) slam.process(*world.view(seq));
    std::ostringstream out;
    geometry::write_tum_trajectory(out, slam.trajectory());
    write_ply(out, slam.map_points());
    text = out.str();
  }
  EXPECT_EQ(texts[0], texts[1]);
}

TEST(SlamSystems, ends_without_having_seen_a_frame) {
  for (const MappingMode mode : {MappingMode::kSynchronous, MappingMode::kThreaded}) {
    SlamSystem slam = make_slam(mode);
    slam.finish();
    EXPECT_TRUE(slam.trajectory().empty());
    EXPECT_TRUE(slam.map_points().empty());
  }
}

TEST(SlamSystems, maps_in_a_thread_as_well) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam(MappingMode::kThreaded);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    ASSERT_EQ(slam.process(*world.view(seq)).result.state, TrackingState::kOk) << "frame " << seq;
  }
  slam.finish();
  const auto trajectory = slam.trajectory();
  ASSERT_EQ(trajectory.size(), kFrames);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    EXPECT_LT((trajectory[seq].T_world_body.translation() - FeatureWorld::T_world_camera(seq).translation()).norm(),
              0.01);
  }
}

TEST(SlamSystems, is_lost_without_features_and_recovers) {
  const FeatureWorld world({});
  SlamConfig config = test_support::settled();
  config.tracker.recently_lost_s = 0.14;  // five frames
  config.techniques.prediction = false;
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  std::uint64_t seq = 0;
  for (; seq < 20; ++seq) slam.process(*world.view(seq));
  const std::size_t tracked = slam.frames_tracked();
  for (; seq < 30; ++seq) {
    const SlamOutput output = slam.process(*empty_view(seq));
    EXPECT_EQ(output.result.state, seq < 25 ? TrackingState::kRecentlyLost : TrackingState::kLost) << "frame " << seq;
    EXPECT_FALSE(output.problem.empty());
  }
  EXPECT_EQ(slam.frames_tracked(), tracked) << "a pose was invented";
  for (int i = 0; i < 2; ++i) {  // found, but not believed at once
    EXPECT_EQ(slam.process(*world.view(seq++)).result.state, TrackingState::kRelocalizing);
    EXPECT_EQ(slam.frames_tracked(), tracked);
  }
  const SlamOutput back = slam.process(*world.view(seq));
  ASSERT_EQ(back.result.state, TrackingState::kOk) << back.problem;
  EXPECT_LT(position_error_m(back.result.T_world_camera, seq), 1e-3);
}

/// Half of the features lie on a thing that is carried along with the camera.
std::unique_ptr<msg::FeatureFrame> beside_carried_thing(const FeatureWorld& world, std::uint64_t seq,
                                                        std::uint8_t flags) {
  auto frame = world.view(seq);
  const auto thing = FeatureWorld({.seed = 9}).view(0);
  for (std::uint32_t i = 0; i < std::min(frame->count, thing->count); i += 2) {
    frame->features[i] = thing->features[i];
    frame->features[i].flags = flags;
  }
  return frame;
}

TEST_F(SlamSystemTest, what_is_in_question_does_not_take_the_pose_along) {
  for (std::uint64_t seq = 0; seq < 20; ++seq) {
    const std::uint8_t flags = seq < 10 ? msg::kFeatureInQuestion : msg::kFeatureRemoved;
    const SlamOutput output = slam_.process(*beside_carried_thing(world_, seq, flags));
    ASSERT_TRUE(msg::is_measured(output.result.state)) << "frame " << seq << ": " << output.problem;
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 0.01) << "frame " << seq;
  }
}

TEST_F(SlamSystemTest, finds_back_after_a_jump) {
  for (std::uint64_t seq = 0; seq < 10; ++seq) slam_.process(*world_.view(seq));
  constexpr std::uint64_t kFar = 30;  // half a metre and twenty degrees away, in the next frame
  auto jumped = world_.view(10, FeatureWorld::T_world_camera(kFar));
  const SlamOutput output = slam_.process(*jumped);
  ASSERT_EQ(output.result.state, TrackingState::kOk) << output.problem;
  EXPECT_LT(position_error_m(output.result.T_world_camera, kFar), 1e-3);
}

TEST_F(SlamSystemTest, stays_initializing_without_depth) {
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    auto frame = world_.view(seq);
    for (msg::Feature& feature : frame->features) feature.depth_m = 0;
    const SlamOutput output = slam_.process(*frame);
    EXPECT_EQ(output.result.state, TrackingState::kInitializing);
    EXPECT_THAT(output.problem, ::testing::HasSubstr("depth"));
    EXPECT_TRUE(output.changes.empty());
  }
  EXPECT_EQ(slam_.process(*world_.view(3)).result.state, TrackingState::kOk);
}

TEST_F(SlamSystemTest, drops_features_with_impossible_values_and_counts_them) {
  slam_.process(*world_.view(0));
  auto frame = world_.view(1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame->features[0].u_px = nan;
  frame->features[1].depth_m = nan;
  frame->features[2].depth_m = -1;
  frame->features[3].angle_rad = std::numeric_limits<float>::infinity();
  frame->features[4].static_probability = nan;
  frame->features[5].static_probability = 2;
  frame->features[6].octave = 8;
  const SlamOutput output = slam_.process(*frame);
  EXPECT_EQ(output.invalid_features, 7U);
  EXPECT_EQ(output.result.state, TrackingState::kOk);
  EXPECT_LT(position_error_m(output.result.T_world_camera, 1), 1e-3);
}

TEST_F(SlamSystemTest, refuses_frames_without_intrinsics_or_size) {
  auto frame = world_.view(0);
  frame->intrinsics = {0, 0, 0, 0};
  EXPECT_THAT(slam_.process(*frame).problem, ::testing::HasSubstr("intrinsics"));
  slam_.process(*world_.view(1));
  frame = world_.view(2);
  for (const double readout_s : {0.11, -0.11, std::nan("")}) {
    frame->readout_s = readout_s;
    EXPECT_THAT(slam_.process(*frame).problem, ::testing::HasSubstr("readout time")) << readout_s;
    EXPECT_EQ(slam_.readout_s(), 0);
  }
  frame = world_.view(2);
  frame->count = msg::kMaxFeatures + 1;
  const SlamOutput output = slam_.process(*frame);
  EXPECT_NE(output.result.state, TrackingState::kOk);
  EXPECT_THAT(output.problem, ::testing::HasSubstr("out of range"));
  EXPECT_EQ(slam_.process(*world_.view(3)).result.state, TrackingState::kOk);
}

TEST_F(SlamSystemTest, keeps_its_map_when_the_source_starts_again) {
  for (std::uint64_t seq = 0; seq < 40; ++seq) slam_.process(*world_.view(seq));
  const SlamOutput output = slam_.process(*world_.view(0));
  EXPECT_EQ(slam_.source_restarts(), 1U);
  ASSERT_EQ(output.result.state, TrackingState::kOk) << output.problem;
  EXPECT_LT(position_error_m(output.result.T_world_camera, 0), 1e-3);
  EXPECT_EQ(slam_.process(*world_.view(1)).result.state, TrackingState::kOk);
}

TEST_F(SlamSystemTest, never_uses_removed_features) {
  for (std::uint64_t seq = 0; seq < 30; ++seq) {
    auto frame = world_.view(seq);
    std::uint32_t removed = 0;
    for (std::uint32_t i = 0; i < frame->count; ++i) {
      msg::Feature& feature = frame->features[i];
      if (feature.u_px >= 320) continue;
      // The left half moves: 0.5 m nearer and ten pixels further in each frame.
      feature.u_px = static_cast<float>((static_cast<std::uint64_t>(feature.u_px) + 10 * seq) % 320);
      feature.depth_m -= 0.5F;
      feature.flags = msg::kFeatureRemoved;
      ++removed;
    }
    const SlamOutput output = slam_.process(*frame);
    ASSERT_EQ(output.result.state, TrackingState::kOk);
    EXPECT_EQ(output.result.features_removed, removed);
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 1e-3) << "frame " << seq;
  }
}

TEST_F(SlamSystemTest, low_static_probability_takes_the_weight_from_moving_objects) {
  double worst_m = 0;
  for (std::uint64_t seq = 0; seq < 30; ++seq) {
    auto frame = world_.view(seq);
    for (std::uint32_t i = 0; i < frame->count; ++i) {
      msg::Feature& feature = frame->features[i];
      if (feature.u_px >= 200) continue;
      feature.v_px += 0.4F * static_cast<float>(seq);  // a third of the image creeps away, too slowly to be an outlier
      feature.static_probability = 0.01F;
    }
    const SlamOutput output = slam_.process(*frame);
    ASSERT_EQ(output.result.state, TrackingState::kOk);
    worst_m = std::max(worst_m, position_error_m(output.result.T_world_camera, seq));
  }
  EXPECT_LT(worst_m, 2e-3);
}

/// A wall that is too far for its depth to be measured, from second 1.5 on with an undetected man in front.
std::unique_ptr<msg::FeatureFrame> wall_and_walker(const FeatureWorld& wall, const FeatureWorld& man,
                                                   std::uint64_t seq) {
  constexpr std::uint64_t kAppears = 45;
  auto frame = wall.view(seq);
  if (seq < kAppears) return frame;
  for (std::uint32_t i = 0; i < frame->count; ++i) frame->features[i].depth_m = 0;
  Eigen::Isometry3d T_man_camera = FeatureWorld::T_world_camera(seq);
  T_man_camera.translation().x() -= 0.03 * static_cast<double>(seq - kAppears);  // he walks to the right
  const auto seen = man.view(seq, T_man_camera);
  for (std::uint32_t i = 0; i < seen->count && frame->count < msg::kMaxFeatures; ++i)
    frame->features[frame->count++] = seen->features[i];
  return frame;
}

TEST(SlamSystems, who_walks_near_by_does_not_outweigh_a_far_wall_that_was_seen_at_rest) {
  FeatureWorld::Options options{.points = 900, .min_depth_m = 5.2, .max_depth_m = 5.6};
  options.noise_px = 0.5;
  const FeatureWorld wall(options);
  options.points = 300;
  options.min_depth_m = 2;
  options.max_depth_m = 2.2;
  options.seed = 2;
  const FeatureWorld man(options);
  SlamSystem slam = make_slam();
  double worst_m = 0;
  for (std::uint64_t seq = 0; seq < 75; ++seq) {
    const SlamOutput output = slam.process(*wall_and_walker(wall, man, seq));
    worst_m = std::max(worst_m, position_error_m(output.result.T_world_camera, seq));
  }
  EXPECT_LT(worst_m, 0.2) << "he walked 0.9 m; weights without the distance follow him for 0.4";
}

TEST(SlamSystems, changes_are_the_whole_history_of_the_keyframes) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam();
  std::uint64_t changes = 0;
  std::set<std::uint32_t> known;
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    for (const KeyframeChange& change : output.changes) {
      switch (change.kind) {
        case KeyframeChange::Kind::kCreated:
          EXPECT_TRUE(known.insert(change.id).second);
          EXPECT_EQ(change.frame_seq, seq);
          break;
        case KeyframeChange::Kind::kCorrected:
          EXPECT_TRUE(known.count(change.id));
          break;
        case KeyframeChange::Kind::kRemoved:
          EXPECT_EQ(known.erase(change.id), 1U);
          break;
      }
    }
    changes += output.changes.size();
    EXPECT_EQ(output.result.event_count, changes);
    EXPECT_EQ(output.result.keyframes, known.size());
  }
}

}  // namespace
}  // namespace rtd::slam
