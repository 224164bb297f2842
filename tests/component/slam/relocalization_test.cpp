// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/relocalizer.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <limits>
#include <thread>

#include "common/msg/transform_eigen.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;

constexpr int kDark = 60;  ///< frames after which tracking is lost, not only recently

/// Slam that is shown views of its world in any order; frames are counted and stamped as they come.
class Relocalization : public ::testing::Test {
 protected:
  explicit Relocalization(MappingMode mode = MappingMode::kSynchronous) : mode_(mode) {}
  void SetUp() override { restart(test_support::settled()); }
  void restart(const SlamConfig& config) {
    slam_ = std::make_unique<SlamSystem>(config, mode_, [] { return std::int64_t{0}; });
  }

  std::unique_ptr<msg::FeatureFrame> view(const FeatureWorld& world, std::uint64_t pose_of) const {
    auto frame = world.view(next_, FeatureWorld::T_world_camera(pose_of));
    frame->stamp_ns = FeatureWorld::stamp_ns(next_);
    return frame;
  }
  SlamOutput show(const msg::FeatureFrame& frame) {
    ++next_;
    if (mode_ == MappingMode::kThreaded) std::this_thread::sleep_for(std::chrono::milliseconds(8));
    return slam_->process(frame);
  }
  SlamOutput look(std::uint64_t pose_of) { return show(*view(world_, pose_of)); }
  void map_frames(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) ASSERT_EQ(look(i).result.state, TrackingState::kOk) << i;
  }
  void cover(int frames) {
    auto dark = view(world_, 0);
    dark->count = 0;
    for (int i = 0; i < frames; ++i) {
      dark->seq = next_;
      dark->stamp_ns = FeatureWorld::stamp_ns(next_);
      const FrameResult result = show(*dark).result;
      last_dark_ = result.state;
      EXPECT_NE(result.state, TrackingState::kOk);
    }
  }
  static double error_m(const FrameResult& result, std::uint64_t pose_of) {
    return (result.T_world_camera.translation() - FeatureWorld::T_world_camera(pose_of).translation()).norm();
  }
  /// Frames until the pose is back, at a view that moves on from `pose_of`; -1: not within a second.
  int frames_until_found(std::uint64_t pose_of) {
    for (int i = 0; i < 30; ++i) {
      const FrameResult result = look(pose_of + static_cast<std::uint64_t>(i)).result;
      if (result.state != TrackingState::kOk) continue;
      EXPECT_LT(error_m(result, pose_of + static_cast<std::uint64_t>(i)), 0.01) << "m";
      return i;
    }
    return -1;
  }

  const FeatureWorld world_ = FeatureWorld::noisy(1), elsewhere_ = FeatureWorld::noisy(2);
  const MappingMode mode_;
  std::unique_ptr<SlamSystem> slam_;
  std::uint64_t next_ = 0;
  TrackingState last_dark_ = TrackingState::kOk;
};

class ThreadedRelocalization : public Relocalization {
 protected:
  ThreadedRelocalization() : Relocalization(MappingMode::kThreaded) {}
};

TEST_F(Relocalization, finds_the_camera_after_three_seconds_of_darkness) {
  map_frames(60);
  cover(90);
  EXPECT_EQ(last_dark_, TrackingState::kLost);
  EXPECT_EQ(frames_until_found(20), 2) << "the confirming frames";
  EXPECT_EQ(slam_->maps().size(), 1U);
}

TEST_F(Relocalization, finds_a_camera_that_was_carried_away) {
  map_frames(60);
  const int frames = frames_until_found(10);
  EXPECT_GE(frames, 0);
  EXPECT_LE(frames, 5);
  EXPECT_EQ(slam_->maps().size(), 1U);
}

TEST_F(ThreadedRelocalization, finds_the_camera_too) {
  map_frames(60);
  cover(kDark);
  const int frames = frames_until_found(20);
  EXPECT_GE(frames, 2);
  EXPECT_LE(frames, 20);
}

TEST_F(Relocalization, needs_no_depth_at_a_known_place) {
  map_frames(60);
  cover(kDark);
  for (int i = 0; i < 10; ++i) {
    auto frame = view(world_, 20);
    for (msg::Feature& feature : frame->features) feature.depth_m = 0;
    const FrameResult result = show(*frame).result;
    if (result.state != TrackingState::kOk) continue;
    EXPECT_LT(error_m(result, 20), 0.02);
    return;
  }
  ADD_FAILURE() << "not found without depth";
}

TEST_F(Relocalization, gives_out_no_pose_before_the_next_frames_agree) {
  SlamConfig config = test_support::settled();
  config.place.confirmations = 3;
  restart(config);
  map_frames(60);
  cover(kDark);
  const std::size_t tracked = slam_->frames_tracked();
  for (int i = 0; i < 3; ++i) {
    const FrameResult result = look(20).result;
    EXPECT_EQ(result.state, TrackingState::kRelocalizing);
    EXPECT_EQ(result.T_world_camera.matrix(), Eigen::Matrix4d::Identity());
  }
  EXPECT_EQ(slam_->frames_tracked(), tracked);
  EXPECT_EQ(look(20).result.state, TrackingState::kOk);
}

TEST_F(Relocalization, recognises_nothing_elsewhere) {
  SlamConfig config = test_support::settled();
  config.place.new_map_after_s = 0;
  restart(config);
  map_frames(60);
  cover(kDark);
  for (std::uint64_t i = 0; i < 120; ++i) {
    EXPECT_EQ(show(*view(elsewhere_, i)).result.state, TrackingState::kLost) << i;
  }
  EXPECT_EQ(slam_->maps().size(), 1U);
}

TEST_F(Relocalization, begins_a_new_map_at_unknown_views_and_comes_back) {
  map_frames(60);
  std::vector<FrameResult> results;
  for (std::uint64_t i = 0; i < 150; ++i) results.push_back(show(*view(elsewhere_, i)).result);
  const auto begun = std::find_if(results.begin(), results.end(), [](const auto& r) { return r.map_id == 1; });
  ASSERT_NE(begun, results.end());
  EXPECT_NEAR(static_cast<double>(begun - results.begin()) / 30, 3.5, 0.2) << "s: half of it predicted";
  for (auto r = begun; r != results.end(); ++r) EXPECT_EQ(r->state, TrackingState::kOk);
  const auto origin = static_cast<std::uint64_t>(begun - results.begin());
  const Eigen::Isometry3d T_origin_last =
      FeatureWorld::T_world_camera(origin).inverse() * FeatureWorld::T_world_camera(149);
  EXPECT_LT((results.back().T_world_camera.translation() - T_origin_last.translation()).norm(), 0.02)
      << "m, in the new map's own frame";
  EXPECT_EQ(results.back().maps, 2U);
  EXPECT_THAT(slam_->maps(), ::testing::ElementsAre(0U, 1U));
  EXPECT_EQ(slam_->trajectory(0).size(), 60U);
  EXPECT_EQ(slam_->trajectory(1).size(), static_cast<std::size_t>(results.end() - begun));

  for (int i = 0; i < 20; ++i) {  // home again
    const FrameResult result = look(30).result;
    if (result.state != TrackingState::kOk) continue;
    EXPECT_EQ(result.map_id, 0U);
    EXPECT_LT(error_m(result, 30), 0.01);
    return;
  }
  ADD_FAILURE() << "the first map was not found again";
}

TEST_F(Relocalization, a_covered_camera_begins_no_map) {
  map_frames(60);
  cover(300);
  EXPECT_EQ(slam_->maps().size(), 1U);
  EXPECT_EQ(frames_until_found(20), 2);
}

TEST_F(Relocalization, survives_impossible_features_while_lost) {
  map_frames(60);
  cover(20);
  auto broken = view(world_, 20);
  for (std::uint32_t i = 0; i < broken->count; ++i) {
    broken->features[i].u_px = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e30F;
    broken->features[i].depth_m = -std::numeric_limits<float>::infinity();
  }
  show(*broken);
  auto alike = view(world_, 20);  // one descriptor for all
  for (msg::Feature& feature : alike->features) feature.descriptor.fill(0x5A);
  EXPECT_NE(show(*alike).result.state, TrackingState::kOk);
  auto doubled = view(world_, 20);
  for (int i = 0; i < 3; ++i) slam_->process(*doubled);  // the same seq and stamp again
  next_ = 7;                                             // and ids that jump back
  EXPECT_GE(frames_until_found(20), 0);
}

TEST_F(Relocalization, same_input_same_bits) {
  const auto run = [&] {
    restart(test_support::settled());
    next_ = 0;
    map_frames(50);
    cover(20);
    std::vector<Eigen::Matrix4d> poses;
    for (std::uint64_t i = 0; i < 10; ++i) poses.push_back(look(15 + i).result.T_world_camera.matrix());
    return poses;
  };
  const auto first = run(), second = run();
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(Eigen::Matrix4d)), 0);
}

TEST_F(Relocalization, without_place_recognition_the_window_is_searched_as_before) {
  SlamConfig config = test_support::settled();
  config.techniques.place_recognition = false;
  restart(config);
  map_frames(60);
  cover(kDark);
  EXPECT_GE(frames_until_found(20), 0);
}

TEST(UnknownViewClock, counts_only_time_with_a_view) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  UnknownViewClock clock;
  EXPECT_EQ(clock.observe(0, true), 0.0);
  EXPECT_NEAR(clock.observe(kSecond / 10, true), 0.1, 1e-9);
  EXPECT_NEAR(clock.observe(5 * kSecond, false), 0.1, 1e-9) << "covered";
  EXPECT_NEAR(clock.observe(6 * kSecond, true), 0.1, 1e-9) << "the cover's time is not that of a view";
  EXPECT_NEAR(clock.observe(9 * kSecond, true), 0.6, 1e-9) << "a gap counts half a second";
  EXPECT_NEAR(clock.observe(8 * kSecond, true), 0.6, 1e-9) << "stamps that go back count nothing";
  clock.reset();
  EXPECT_EQ(clock.observe(0, true), 0.0);
}

}  // namespace
}  // namespace rtd::slam
