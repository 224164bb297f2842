// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/inboxes.hpp"

#include <gtest/gtest.h>

#include <future>

namespace rtd::filter {
namespace {

using namespace std::chrono_literals;

msg::TrackingResult result(std::uint64_t seq, std::uint64_t event_count) {
  msg::TrackingResult result{};
  result.seq = seq;
  result.event_count = event_count;
  return result;
}
msg::KeyframeEvent event(std::uint64_t index) {
  msg::KeyframeEvent event{};
  event.event_index = index;
  return event;
}

TEST(SlamFeedback, is_complete_only_with_all_events_of_the_frame) {
  SlamFeedback feedback;
  feedback.put(result(7, 2));
  feedback.put(event(0));
  EXPECT_FALSE(feedback.take_after(7, 1ms).complete);
  feedback.put(event(1));
  const SlamUpdate update = feedback.take_after(7, 1ms);
  EXPECT_TRUE(update.complete);
  EXPECT_EQ(update.events.size(), 1U) << "the first event was taken before";
}

TEST(SlamFeedback, waits_for_the_frame_asked_for) {
  SlamFeedback feedback;
  feedback.put(result(6, 0));
  auto waiting = std::async(std::launch::async, [&] { return feedback.take_after(7, 5s); });
  feedback.put(result(7, 0));
  EXPECT_TRUE(waiting.get().complete);
}

TEST(SlamFeedback, a_restarted_slam_counts_its_events_from_zero) {
  SlamFeedback feedback;
  feedback.put(event(41));
  feedback.put(result(7, 42));
  EXPECT_TRUE(feedback.take_after(7, 1ms).complete);
  feedback.put(result(8, 1));
  feedback.put(event(0));
  EXPECT_TRUE(feedback.take_after(8, 1ms).complete);
}

TEST(SlamFeedback, is_complete_with_the_result_and_all_events_before_it) {
  SlamFeedback feedback;
  const std::chrono::milliseconds no_time{0};
  msg::TrackingResult result{};
  result.seq = 4;
  result.event_count = 2;
  feedback.put(result);
  msg::KeyframeEvent event{};
  feedback.put(event);
  EXPECT_FALSE(feedback.take_after(4, no_time).complete);
  event.event_index = 1;
  feedback.put(event);
  EXPECT_TRUE(feedback.take_after(4, no_time).complete);
  EXPECT_TRUE(feedback.take().results.empty()) << "each result is handed out once";
}

}  // namespace
}  // namespace rtd::filter
