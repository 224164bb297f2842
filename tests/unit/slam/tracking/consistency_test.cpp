// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "services/slam/core/corrections.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/core/tracking/consistency.hpp"
#include "services/slam/core/tracking/witnesses.hpp"
#include "tests/support/feature_world.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;

constexpr double kPeriod_s = 0.033, kScene_m = 3, kSigma_m = 0.001;

/// A frame that was tracked: `inliers` landmarks 2 m away and off by `error_px` (standard deviation), others rejected.
struct Tracked {
  Frame frame;
  LocalMap map;
  LocalMapTracking tracking;

  Tracked(std::uint32_t inliers, std::uint32_t rejected, double error_px, std::uint32_t seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, error_px);
    std::uniform_real_distribution<double> u(20, 620), v(20, 460);
    frame.camera = {500, 500, 320, 240};
    for (std::uint32_t i = 0; i < inliers; ++i) {
      msg::Feature feature{};
      const double u_px = u(random), v_px = v(random);
      feature.u_px = static_cast<float>(u_px + error(random));
      feature.v_px = static_cast<float>(v_px + error(random));
      frame.features.push_back(feature);
      LocalLandmark landmark;
      landmark.id = i;
      landmark.position = {(u_px - 320) / 500 * 2, (v_px - 240) / 500 * 2, 2};
      map.landmarks.push_back(landmark);
      tracking.guess.landmarks.push_back(i);
    }
    tracking.guess.success = true;
    tracking.guess.inliers = static_cast<int>(inliers);
    tracking.rejected.resize(rejected);
  }
};

Consistency after(int frames, const Tracked& seen, double period_s = kPeriod_s) {
  Consistency consistency{ConsistencyConfig{}};
  for (int i = 0; i < frames; ++i) consistency.add(seen.frame, seen.map, seen.tracking, period_s);
  return consistency;
}

TEST(Consistency, trusts_a_pose_that_most_of_the_image_agrees_with) {
  Consistency good = after(60, Tracked(300, 80, 0.5));
  EXPECT_NEAR(good.value(), 300.0 / 380, 0.03);
  EXPECT_FALSE(good.doubts(kSigma_m));
  EXPECT_EQ(good.covariance(kScene_m).trace(), 0);
}

TEST(Consistency, doubts_a_pose_that_much_of_the_image_contradicts) {
  Consistency bad = after(60, Tracked(300, 450, 0.5));
  EXPECT_NEAR(bad.value(), 0.4, 0.03);
  EXPECT_TRUE(bad.doubts(kSigma_m));
  EXPECT_GT(std::sqrt(bad.covariance(kScene_m)(0, 0)), 0.05) << "m";
  EXPECT_NEAR(bad.covariance(kScene_m)(3, 3), bad.covariance(kScene_m)(0, 0) / (kScene_m * kScene_m), 1e-9);
}

TEST(Consistency, doubts_a_pose_that_the_image_agrees_with_loosely) {
  EXPECT_TRUE(after(60, Tracked(300, 150, 1.3)).doubts(kSigma_m));
  EXPECT_FALSE(after(60, Tracked(300, 100, 0.7)).doubts(kSigma_m)) << "a coarser sensor";
}

TEST(Consistency, doubts_an_uncertain_pose_the_sooner_the_less_agrees) {
  Consistency good = after(60, Tracked(300, 100, 0.5)), poor = after(60, Tracked(300, 300, 0.5));  // 0.75, 0.50
  EXPECT_FALSE(good.doubts(0.012));
  EXPECT_TRUE(good.doubts(0.04));
  EXPECT_TRUE(poor.doubts(0.012));
  EXPECT_FALSE(poor.doubts(kSigma_m));
}

TEST(Consistency, is_certain_again_only_when_clearly_below_the_limit) {
  Consistency consistency = after(60, Tracked(300, 128, 0.5));  // 0.70
  const double limit_m = 0.02 * std::exp(7 * (consistency.value() - 0.7));
  EXPECT_NEAR(limit_m, 0.02, 0.003);
  EXPECT_FALSE(consistency.doubts(0.95 * limit_m));
  EXPECT_TRUE(consistency.doubts(1.05 * limit_m));
  EXPECT_TRUE(consistency.doubts(0.95 * limit_m));
  EXPECT_FALSE(consistency.doubts(0.9 * limit_m));
}

TEST(Consistency, never_doubts_with_a_share_of_0) {
  ConsistencyConfig config;
  config.doubtful_below = 0;
  EXPECT_FALSE(Consistency{config}.doubts(1));
}

TEST(Consistency, looks_at_time_and_not_at_frames) {
  const Tracked bad(300, 450, 0.5);
  EXPECT_FALSE(after(3, bad).doubts(kSigma_m)) << "a tenth of a second";
  EXPECT_TRUE(after(60, bad).doubts(kSigma_m));
  EXPECT_NEAR(after(10, bad, 0.2).value(), after(60, bad).value(), 0.01) << "two seconds at 5 Hz";
}

TEST(Consistency, says_nothing_about_a_handful_of_matches) {
  EXPECT_FALSE(after(60, Tracked(8, 11, 2)).doubts(kSigma_m));
}

TEST(Consistency, trusts_again_only_when_clearly_better) {
  Consistency consistency = after(60, Tracked(300, 450, 0.5));  // 0.40
  EXPECT_TRUE(consistency.doubts(kSigma_m));
  const Tracked little_better(300, 380, 0.5), good(300, 80, 0.5);
  for (int i = 0; i < 60; ++i) {
    consistency.add(little_better.frame, little_better.map, little_better.tracking, kPeriod_s);
  }
  EXPECT_TRUE(consistency.doubts(kSigma_m)) << "0.44";
  for (int i = 0; i < 60; ++i) consistency.add(good.frame, good.map, good.tracking, kPeriod_s);
  EXPECT_FALSE(consistency.doubts(kSigma_m));
  consistency.reset();
  EXPECT_FALSE(consistency.doubts(kSigma_m));
}

/// A map of one keyframe, and the frame after it, recorded 3 cm off while half of its features were in question.
class UnsettledFramesTest : public ::testing::Test {
 protected:
  UnsettledFramesTest() {
    const KeyframeId keyframe =
        map_.add_keyframe(make_frame(*world_.view(0), {}).frame, FeatureWorld::T_world_camera(0), kNoKeyframe);
    create_from_depth(map_, keyframe, 10);
    local_ = make_local_map(map_, keyframe, 1, 60);
    Eigen::Isometry3d T_off = FeatureWorld::T_world_camera(1);
    T_off.translation().x() += 0.03;
    records_.push_back({1, FeatureWorld::stamp_ns(1), keyframe, FeatureWorld::T_world_camera(0).inverse() * T_off});
  }
  void add(std::uint64_t seq, bool in_question) {
    auto message = world_.view(seq);
    for (std::uint32_t i = 0; in_question && i < message->count; i += 2)
      message->features[i].flags |= msg::kFeatureInQuestion;
    TrackedFrame tracked;
    tracked.frame = make_frame(*message, {}).frame;
    tracked.landmarks.assign(tracked.frame->features.size(), kNoLandmark);
    frames_.add(tracked, *local_, {config_, [] { return std::int64_t{0}; }}, records_);
  }
  double error_m() const {
    const Eigen::Isometry3d T_world_camera = FeatureWorld::T_world_camera(0) * records_[0].T_reference_camera;
    return (T_world_camera.translation() - FeatureWorld::T_world_camera(1).translation()).norm();
  }

  const FeatureWorld world_ = FeatureWorld({});
  const SlamConfig config_;
  Map map_;
  LocalMapPtr local_;
  std::vector<FrameRecord> records_;
  DeferredFrames frames_;
};

TEST_F(UnsettledFramesTest, are_judged_again_when_nothing_is_in_question_for_a_while) {
  add(1, true);
  add(5, false);  // 0.13 s
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
  add(12, false);
  EXPECT_LT(error_m(), 0.002);
}

TEST_F(UnsettledFramesTest, keep_their_pose_when_nothing_was_in_question) {
  add(1, false);
  add(20, false);
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
}

TEST_F(UnsettledFramesTest, keep_their_pose_without_their_keyframe) {
  records_[0].reference = 7;
  add(1, true);
  add(20, false);
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
}

TEST_F(UnsettledFramesTest, that_are_no_longer_recorded_do_not_count) {
  records_[0].seq = 99;
  add(1, true);
  add(20, false);
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
}

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
