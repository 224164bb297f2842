// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What may be asked of a running system: to begin again, to take another map, to leave its map as it is.
#include <gmock/gmock.h>

#include <set>

#include "services/slam/core/map/map_changes.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/unit/slam/store/memory_map_file.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = KeyframeChange::Kind;

class RunningSlam : public ::testing::Test {
 protected:
  static SlamSystem make_slam(MappingMode mode = MappingMode::kSynchronous) {
    return {test_support::settled(), mode, frozen_clock};
  }
  /// Frames from `seq` up to but without `end`; the last output.
  SlamOutput play(SlamSystem& slam, std::uint64_t seq, std::uint64_t end) {
    SlamOutput output;
    for (; seq < end; ++seq) {
      output = slam.process(*world_.view(seq));
      note(output);
    }
    return output;
  }
  void note(const SlamOutput& output) {
    for (const KeyframeChange& change : output.changes) {
      ++events_;
      if (change.kind == Kind::kCreated) announced_.insert(change.frame_seq);
      if (change.kind == Kind::kRemoved) announced_.erase(change.frame_seq);
    }
    EXPECT_EQ(output.result.event_count, events_);
  }
  void reset(SlamSystem& slam) {
    slam.reset();
    events_ = 0;
  }
  static io::Bytes bytes_of(const SlamSystem& slam) {
    return slam.read_map([](const Map& map) { return bytes_of_map(map); });
  }
  static double error_m(const SlamOutput& output, std::uint64_t seq, std::uint64_t origin = 0) {
    const Eigen::Isometry3d T_origin_camera =
        FeatureWorld::T_world_camera(origin).inverse() * FeatureWorld::T_world_camera(seq);
    return (output.result.T_world_camera.translation() - T_origin_camera.translation()).norm();
  }

  const FeatureWorld world_ = FeatureWorld::noisy();
  std::set<std::uint64_t> announced_;  ///< frames whose keyframes readers of the events know
  std::uint64_t events_ = 0;
};

TEST_F(RunningSlam, after_a_reset_everything_is_as_after_a_start) {
  SlamSystem slam = make_slam(), fresh = make_slam();
  play(slam, 0, 60);
  reset(slam);
  for (std::uint64_t seq = 60; seq < 120; ++seq) {
    const SlamOutput output = slam.process(*world_.view(seq)), expected = fresh.process(*world_.view(seq));
    note(output);
    ASSERT_EQ(output.result.state, expected.result.state) << "frame " << seq;
    ASSERT_EQ(output.result.T_world_camera.matrix(), expected.result.T_world_camera.matrix()) << "frame " << seq;
    ASSERT_EQ(output.result.landmarks, expected.result.landmarks) << "frame " << seq;
  }
  EXPECT_EQ(bytes_of(slam), bytes_of(fresh));
  ASSERT_EQ(slam.trajectory().size(), 60U);
  EXPECT_EQ(slam.trajectory().back().T_world_body.matrix(), fresh.trajectory().back().T_world_body.matrix());
}

TEST_F(RunningSlam, a_reset_takes_back_every_keyframe_that_was_announced) {
  SlamSystem slam = make_slam();
  play(slam, 0, 60);
  ASSERT_GT(announced_.size(), 1U);
  reset(slam);
  const SlamOutput output = play(slam, 60, 61);
  EXPECT_EQ(output.result.keyframes, 1U);
  EXPECT_THAT(announced_, ::testing::ElementsAre(60U)) << "the first of the new map";
}

TEST_F(RunningSlam, a_reset_does_not_move_the_odometry) {
  SlamSystem slam = make_slam();
  const SlamOutput before = play(slam, 0, 60);
  reset(slam);
  const SlamOutput after = play(slam, 60, 61);
  const Eigen::Isometry3d T_odom_before = before.T_map_odom.inverse() * before.result.T_world_camera;
  const Eigen::Isometry3d T_odom_after = after.T_map_odom.inverse() * after.result.T_world_camera;
  EXPECT_LT((T_odom_after.translation() - T_odom_before.translation()).norm(), 0.03) << "m";
}

TEST_F(RunningSlam, a_reset_without_a_map_does_no_harm) {
  SlamSystem slam = make_slam();
  reset(slam);
  reset(slam);
  EXPECT_EQ(play(slam, 0, 5).result.state, TrackingState::kOk);
}

TEST_F(RunningSlam, resets_while_the_mapper_works_lose_no_event_and_break_nothing) {
  SlamSystem slam = make_slam(MappingMode::kThreaded);
  constexpr std::uint64_t kBetween = 12;
  for (std::uint64_t seq = 0; seq < 10 * kBetween; seq += kBetween) {
    const SlamOutput output = play(slam, seq, seq + kBetween);
    ASSERT_EQ(output.result.state, TrackingState::kOk) << output.problem;
    EXPECT_LT(error_m(output, seq + kBetween - 1, seq), 0.02) << "m, after frame " << seq;
    reset(slam);
  }
  play(slam, 120, 150);
  slam.finish();
  for (const std::uint64_t seq : announced_) EXPECT_GE(seq, 120U) << "a keyframe of a map that is gone";
  slam.read_map([](const Map& map) { EXPECT_EQ(map.check_invariants(), ""); });
}

TEST_F(RunningSlam, viewers_are_notified_that_the_map_is_another_one) {
  SlamSystem slam = make_slam();
  MapChanges changes;
  play(slam, 0, 30);
  changes.update(slam.map_view());
  reset(slam);
  EXPECT_TRUE(changes.update(slam.map_view()).new_session);
  play(slam, 30, 40);
  const MapNews news = changes.update(slam.map_view());
  EXPECT_FALSE(news.new_session);
  EXPECT_FALSE(news.keyframes.empty());
}

TEST_F(RunningSlam, a_loaded_map_replaces_the_present_one_and_the_camera_is_found_in_it) {
  SlamSystem first = make_slam(), slam = make_slam();
  play(first, 0, 90);
  const io::Bytes saved = bytes_of(first);
  events_ = 0;
  announced_.clear();
  play(slam, 40, 70);  // its world begins elsewhere
  slam.set_localize_only(true);
  slam.load_map(read_bytes(saved));
  events_ = 0;
  EXPECT_EQ(bytes_of(slam), saved);
  SlamOutput output = play(slam, 70, 71);
  EXPECT_EQ(output.result.state, TrackingState::kRelocalizing);
  output = play(slam, 71, 90);
  EXPECT_EQ(output.result.state, TrackingState::kOk) << output.problem;
  EXPECT_LT(error_m(output, 89), 0.02) << "m, in the world of the loaded map";
  EXPECT_EQ(bytes_of(slam), saved) << "localize_only";
  EXPECT_THAT(announced_, IsEmpty());
}

TEST_F(RunningSlam, localize_only_adds_nothing_while_it_is_on) {
  SlamSystem slam = make_slam();
  const SlamOutput before = play(slam, 0, 40);
  slam.set_localize_only(true);
  const io::Bytes map = bytes_of(slam);
  const SlamOutput during = play(slam, 40, 120);
  EXPECT_EQ(during.result.keyframes, before.result.keyframes);
  EXPECT_EQ(bytes_of(slam), map);
  slam.set_localize_only(false);
  const SlamOutput after = play(slam, 120, 200);
  EXPECT_EQ(after.result.state, TrackingState::kOk);
  EXPECT_GT(after.result.keyframes, before.result.keyframes);
  slam.read_map([](const Map& found) { EXPECT_EQ(found.check_invariants(), ""); });
}

TEST_F(RunningSlam, localize_only_without_a_map_says_what_is_missing) {
  SlamSystem slam = make_slam();
  play(slam, 0, 10);
  slam.set_localize_only(true);
  reset(slam);
  const SlamOutput output = play(slam, 10, 12);
  EXPECT_EQ(output.result.state, TrackingState::kInitializing);
  EXPECT_THAT(output.problem, HasSubstr("there is no map"));
  slam.set_localize_only(false);
  EXPECT_EQ(play(slam, 12, 14).result.state, TrackingState::kOk);
}

}  // namespace
}  // namespace rtd::slam
