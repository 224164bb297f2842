// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/witnesses.hpp"

#include <gmock/gmock.h>

#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;

constexpr double kFrame_s = 1.0 / 30;

/// A room of which a walker who was not detected leaves `visible` features from frame `arrival` on.
class WalkedRoom {
 public:
  WalkedRoom(std::uint64_t arrival, std::uint32_t visible) : arrival_(arrival), visible_(visible) {}

  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq) const {
    auto frame = room_.view(seq);
    if (seq < arrival_) return frame;
    frame->count = std::min(frame->count, visible_);
    Eigen::Isometry3d T_world_walker = Eigen::Isometry3d::Identity();
    T_world_walker.translation().x() = kWalk_m_s * kFrame_s * static_cast<double>(seq - arrival_);
    const auto walker = walker_.view(seq, T_world_walker.inverse() * FeatureWorld::T_world_camera(seq));
    for (std::uint32_t i = 0; i < std::min(walker->count, kWalkersFeatures); ++i)
      frame->features[frame->count++] = walker->features[i];
    return frame;
  }

 private:
  static constexpr double kWalk_m_s = 1;
  static constexpr std::uint32_t kWalkersFeatures = 300;
  FeatureWorld room_ = FeatureWorld::noisy();
  FeatureWorld walker_{{.points = 1500, .min_depth_m = 1.0, .max_depth_m = 1.4, .noise_px = 0.5, .seed = 9}};
  std::uint64_t arrival_;
  std::uint32_t visible_;
};

double error_m(const FrameResult& result) {
  return (result.T_world_camera.translation() - FeatureWorld::T_world_camera(result.seq).translation()).norm();
}

/// The largest error of a pose in state ok while a walker covers most of the view.
double worst_ok_error(const SlamConfig& config, std::uint32_t visible) {
  constexpr std::uint64_t kArrival = 40, kEnd = 75;
  const WalkedRoom room(kArrival, visible);
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  double worst_m = 0;
  for (std::uint64_t seq = 0; seq < kEnd; ++seq) {
    const FrameResult result = slam.process(*room.view(seq)).result;
    if (result.state == TrackingState::kOk) worst_m = std::max(worst_m, error_m(result));
  }
  return worst_m;
}

TEST(Witnesses, hold_the_pose_against_a_walker_with_more_features) {
  SlamConfig without;
  without.witness.used = false;
  EXPECT_GT(worst_ok_error(without, 60), 0.1) << "what a pose does that follows the most features";
  EXPECT_LT(worst_ok_error({}, 60), 0.06);
}

TEST(Witnesses, a_map_that_has_just_begun_is_doubtful_until_it_was_seen_to_rest) {
  const FeatureWorld world = FeatureWorld::noisy();
  for (const bool moves : {true, false}) {
    SlamSystem slam({}, MappingMode::kSynchronous, frozen_clock);
    std::uint64_t first_ok = 0;
    for (std::uint64_t seq = 1; seq < 60 && first_ok == 0; ++seq) {
      auto frame = moves ? world.view(seq) : world.view(seq, Eigen::Isometry3d::Identity());
      const SlamOutput output = slam.process(*frame);
      if (output.result.state == TrackingState::kOk && seq > 1) first_ok = seq;
      if (first_ok == 0 && seq > 1) {
        EXPECT_THAT(output.problem, ::testing::HasSubstr("just begun")) << seq;
      }
    }
    EXPECT_GE(first_ok * kFrame_s, 0.5) << moves;
    EXPECT_LE(first_ok * kFrame_s, 1.0) << moves;
  }
}

TEST(Witnesses, a_pose_that_needs_a_jump_is_doubtful) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam({}, MappingMode::kSynchronous, frozen_clock);
  for (std::uint64_t seq = 0; seq < 40; ++seq) slam.process(*world.view(seq));
  Eigen::Isometry3d T_world_camera = FeatureWorld::T_world_camera(40);
  T_world_camera.translation().x() += 0.15;  // 4.5 m/s
  const SlamOutput output = slam.process(*world.view(40, T_world_camera));
  EXPECT_EQ(output.result.state, TrackingState::kDoubtful);
  EXPECT_THAT(output.problem, ::testing::HasSubstr("so fast"));
}

WitnessView usual() {
  return {.with_features = 40, .agreeing = 25, .expected = 30, .found = 20, .witnesses = 120};
}

WitnessVerdict judge_once(const WitnessView& view, const WitnessConfig& config = {}) {
  return WitnessJudge(config).judge(view, 0);
}

TEST(WitnessVerdict, follows_the_witnesses) {
  const WitnessVerdict verdict = judge_once(usual());
  EXPECT_TRUE(verdict.witnessed);
  EXPECT_TRUE(verdict.carried);
  EXPECT_FALSE(verdict.contradicted);
}

TEST(WitnessVerdict, many_others_do_not_replace_witnesses_that_should_be_seen) {
  WitnessView view = usual();
  view.found = 3;
  view.witnesses = 9;
  EXPECT_TRUE(judge_once(view).contradicted);
  EXPECT_FALSE(judge_once(view).carried);
}

TEST(WitnessVerdict, a_new_view_is_carried_by_much_that_agrees) {
  WitnessView view = usual();
  view.expected = view.found = view.witnesses = 2;
  EXPECT_TRUE(judge_once(view).carried);
  EXPECT_FALSE(judge_once(view).contradicted);
  view.agreeing = 8;
  EXPECT_FALSE(judge_once(view).carried) << "one thing in a corner";
  EXPECT_TRUE(judge_once(view).mostly_unknown) << "it needs a keyframe";
  EXPECT_FALSE(judge_once(view).contradicted) << "nothing says otherwise";
}

/// A camera turns away with a person: witnesses contradict, then leave the view; what the map has just learnt agrees.
TEST(WitnessJudge, keeps_a_contradiction_in_mind_until_witnesses_answer_it) {
  WitnessView contradicting = usual(), unknown = usual();
  contradicting.found = contradicting.witnesses = 2;
  unknown.expected = unknown.found = unknown.witnesses = 0;
  const WitnessConfig config;
  WitnessJudge judge(config);
  EXPECT_FALSE(judge.judge(unknown, 0).doubtful) << "nothing has contradicted yet";
  EXPECT_TRUE(judge.judge(contradicting, 100'000'000).doubtful);
  const WitnessVerdict after = judge.judge(unknown, 500'000'000);
  EXPECT_TRUE(after.doubtful);
  EXPECT_FALSE(after.carried) << "or its keyframes would make witnesses of what moves";
  EXPECT_FALSE(after.contradicted) << "keyframes may be made";
  EXPECT_FALSE(judge.judge(usual(), 600'000'000).doubtful) << "witnesses carry it";
  EXPECT_FALSE(judge.judge(unknown, 700'000'000).doubtful);
  EXPECT_TRUE(judge.judge(contradicting, 800'000'000).doubtful);
  const auto long_after_ns = 900'000'000 + static_cast<std::int64_t>(1e9 * config.settle_s);
  EXPECT_FALSE(judge.judge(unknown, long_after_ns).doubtful) << "they may never be seen again";
  EXPECT_TRUE(judge.judge(contradicting, long_after_ns).doubtful);
  judge.forget();
  EXPECT_FALSE(judge.judge(unknown, long_after_ns).doubtful) << "another map";
}

TEST(WitnessVerdict, says_nothing_when_switched_off) {
  WitnessView view = usual();
  view.found = view.witnesses = 0;
  WitnessConfig off;
  off.used = false;
  EXPECT_TRUE(judge_once(view, off).carried);
  EXPECT_FALSE(judge_once(view, off).contradicted);
}

}  // namespace
}  // namespace rtd::slam
