// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// A detector that comes late, is slow, or goes: whom the filter waits for, and what it reports.
#include <gmock/gmock.h>

#include <thread>

#include "common/service/monotonic_clock.hpp"
#include "tests/component/filter/filter_service_fixture.hpp"

namespace rtd::filter {
namespace {

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
