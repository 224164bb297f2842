// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include "common/service/monotonic_clock.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "tests/component/filter/filter_service_fixture.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::MovingScene;
using test::removed_share;

constexpr double kWalkerStepM = 0.02;  // 0.6 m/s

/// A person (the block of the scene) whom only the detector can know: semantic mode. The answers of the detector are
/// given by hand.
class CarriedMask : public ::testing::Test {
 protected:
  static FilterConfig config() {
    FilterConfig config;
    config.mode = FilterMode::kSemantic;
    return config;
  }
  static double block_x_m(std::uint64_t frame) { return -0.3 + kWalkerStepM * static_cast<double>(frame); }
  static std::int64_t stamp(std::uint64_t frame) { return static_cast<std::int64_t>(frame) * 33'333'333; }
  static DetectionBatch batch(std::uint64_t frame) {
    const cv::Rect block = MovingScene::block(0, block_x_m(frame));
    return {stamp(frame),
            {{"person", 0.9F, static_cast<float>(block.x - 5), static_cast<float>(block.y - 5),
              static_cast<float>(block.width + 10), static_cast<float>(block.height + 10)}}};
  }
  FilterResult frame(std::uint64_t number, std::vector<DetectionBatch> batches, bool active = true) {
    return filter_.apply(scene_.render(number, 0, block_x_m(number)), DetectorUpdate{active, std::move(batches)});
  }
  static double on_block(const FilterResult& result, std::uint64_t number) {
    return removed_share(result, MovingScene::block(0, block_x_m(number)), true);
  }
  static double beside_block(const FilterResult& result, std::uint64_t number) {
    return removed_share(result, MovingScene::block(0, block_x_m(number)), false);
  }

  const MovingScene scene_;
  DynamicFilter filter_{config(), [] { return std::int64_t{0}; }};
};

TEST_F(CarriedMask, stays_on_a_walker_with_late_detections_at_five_hertz) {
  for (std::uint64_t i = 0; i < 30; ++i) {
    std::vector<DetectionBatch> batches;
    if (i >= 4 && (i - 4) % 6 == 0) batches.push_back(batch(i - 4));  // 130 ms late
    const FilterResult result = frame(i, std::move(batches));
    if (i < 4) continue;
    EXPECT_GE(on_block(result, i), 0.95) << "frame " << i;
    EXPECT_LE(beside_block(result, i), 0.02) << "frame " << i;
    ASSERT_EQ(result.objects.size(), 1U) << "frame " << i;
    EXPECT_EQ(result.objects[0].track_id, 0) << "frame " << i;
    EXPECT_TRUE(result.objects[0].carried);
  }
}

TEST_F(CarriedMask, stays_on_a_walker_through_a_second_of_silence) {
  for (std::uint64_t i = 0; i < 40; ++i) {
    const FilterResult result = frame(i, i < 5 ? std::vector{batch(i)} : std::vector<DetectionBatch>{});
    if (i >= 35) continue;
    EXPECT_GE(on_block(result, i), 0.95) << "frame " << i;
  }
}

TEST_F(CarriedMask, is_dropped_half_a_second_after_the_detector_has_gone) {
  for (std::uint64_t i = 0; i < 5; ++i) frame(i, {batch(i)});
  FilterResult result;
  for (std::uint64_t i = 5; i < 12; ++i) result = frame(i, {}, false);
  EXPECT_EQ(result.objects.size(), 1U);
  for (std::uint64_t i = 12; i < 25; ++i) result = frame(i, {}, false);
  EXPECT_TRUE(result.objects.empty());
}

TEST_F(CarriedMask, survives_a_broken_detector) {
  const DetectionBatch good = batch(0);
  std::vector<vision::Detection> ten_thousand(10'000, {"person", 0.9F, 10, 10, 50, 50});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<DetectionBatch> batches{good,
                                            good,
                                            {stamp(90), good.detections},
                                            {-stamp(90), good.detections},
                                            {stamp(0), {{"person", nan, nan, 1e30F, -5, 0}}},
                                            {stamp(0), ten_thousand}};
  const FilterResult result = frame(0, batches);
  EXPECT_EQ(result.objects.size(), 1U) << "one answer a frame: the first";
  const FilterResult flooded = frame(1, {{stamp(1), ten_thousand}});
  EXPECT_LE(flooded.objects.size(), kMaxObjects + 1);
}

constexpr std::uint64_t kSits = 300, kWalks = 20, kStands = 90;  // frames at 30 Hz
constexpr double kStepM = 0.03;

/// A person sits for 10 s, walks off at 0.9 m/s and stops, before a camera that sways; a detector sees it in every
/// frame. Rendered and judged once for all tests.
class SittingPerson : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const MovingScene scene;
    FilterConfig config;
    DynamicFilter filter(config, [] { return std::int64_t{0}; });
    for (std::uint64_t i = 0; i < kSits + kWalks + kStands; ++i) {
      const double camera_x_m = 0.03 * std::sin(0.05 * static_cast<double>(i));
      const double steps = i < kSits ? 0.0 : static_cast<double>(std::min(i - kSits + 1, kWalks));
      const double person_x_m = -0.3 + kStepM * steps;
      const cv::Rect person = MovingScene::block(camera_x_m, person_x_m);
      const std::vector<vision::Detection> boxes{
          {"person", 0.9F, static_cast<float>(person.x - 10), static_cast<float>(person.y - 10),
           static_cast<float>(person.width + 20), static_cast<float>(person.height + 20)}};
      const FilterResult result = filter.apply(scene.render(i, camera_x_m, person_x_m), boxes);
      gone_[i] = removed_share(result, person, true);
      background_gone_[i] = removed_share(result, person, false);
    }
  }
  static inline std::map<std::uint64_t, double> gone_, background_gone_;  ///< share of the features, by frame
};

TEST_F(SittingPerson, is_not_used_when_first_seen) {
  EXPECT_GE(gone_.at(0), 0.95);
  EXPECT_GE(gone_.at(5), 0.95);
}

TEST_F(SittingPerson, is_used_again_within_two_seconds) {
  for (std::uint64_t i = 60; i < kSits; i += 10) EXPECT_LE(gone_.at(i), 0.1) << "frame " << i;
}

TEST_F(SittingPerson, is_dropped_within_three_frames_of_rising) {
  for (std::uint64_t i = kSits + 2; i < kSits + kWalks; ++i) EXPECT_GE(gone_.at(i), 0.95) << "frame " << i;
}

TEST_F(SittingPerson, is_used_again_within_two_seconds_of_stopping) {
  EXPECT_GE(gone_.at(kSits + kWalks + 10), 0.9) << "a third of a second is too early";
  for (std::uint64_t i = kSits + kWalks + 60; i < kSits + kWalks + kStands; i += 5)
    EXPECT_LE(gone_.at(i), 0.1) << "frame " << i;
}

TEST_F(SittingPerson, removes_nothing_of_the_room) {
  for (const auto& [frame, share] : background_gone_) EXPECT_LE(share, 0.08) << "frame " << frame;
}

/// A detector that comes late, is slow, or goes: whom the filter waits for, and what it reports.

TEST_F(FilterServiceTest, reports_within_half_a_second_that_the_detector_has_gone_and_its_return) {
  start(service::Pace::kRealtime, true);
  send_frame(0);
  ASSERT_TRUE(wait_state(msg::ServiceState::kRunning));
  detector_beats_.stop();
  const std::int64_t silent_ns = service::monotonic_ns();
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded));
  EXPECT_LT(service::monotonic_ns() - silent_ns, 600'000'000) << "0.5 s and the jitter of a busy host";
  send_frame(30);
  ASSERT_TRUE(answers_.wait_count(2));
  EXPECT_EQ(answers_.at(1)->detection_use, msg::DetectionUse::kDetectorGone);
  detector_beats_.start([this] { say("detector", msg::ServiceState::kReady); });
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning));
}

TEST_F(FilterServiceTest, continues_with_geometry_when_the_detector_ends_in_lockstep) {
  start(service::Pace::kLockstep, true);
  detector_beats_.stop();
  say("detector", msg::ServiceState::kFinished);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kDetectorGone);
  EXPECT_TRUE(wait_state(msg::ServiceState::kDegraded));
}

TEST_F(FilterServiceTest, waits_in_lockstep_for_a_detector_that_is_slow_not_gone) {
  start(service::Pace::kLockstep, true);
  detector_beats_.stop();  // as on a host that stands still
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  send_frame(0);
  EXPECT_FALSE(answers_.wait_count(1, std::chrono::milliseconds(2500))) << "judged without the boxes";
  send_boxes(0, true);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kExact);
}

TEST_F(FilterServiceTest, is_ready_in_lockstep_only_when_the_promised_detector_is) {
  config_.detector = "on";
  launch(service::Pace::kLockstep);
  EXPECT_TRUE(wait_state(msg::ServiceState::kStarting, "waits for a detector"));
  say("detector", msg::ServiceState::kStarting);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(states_.all().back()->state, msg::ServiceState::kStarting) << "it loads its network";
  say("detector", msg::ServiceState::kReady);
  EXPECT_TRUE(wait_state(msg::ServiceState::kReady));
  send_frame(0);
  EXPECT_FALSE(answers_.wait_count(1, std::chrono::milliseconds(300))) << "judged without the boxes";
  send_boxes(0, true);
  EXPECT_TRUE(answers_.wait_count(1));
}

TEST_F(FilterServiceTest, does_not_wait_for_a_detector_that_is_switched_off) {
  config_.detector = "off";
  start(service::Pace::kLockstep, true);
  send_frame(0);
  ASSERT_TRUE(answers_.wait_count(1));
  EXPECT_EQ(answers_.at(0)->detection_use, msg::DetectionUse::kNone);
}

}  // namespace
}  // namespace rtd::filter
