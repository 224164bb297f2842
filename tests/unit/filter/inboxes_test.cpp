// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/inboxes.hpp"

#include <gtest/gtest.h>

#include <future>

namespace rtd::filter {
namespace {

using namespace std::chrono_literals;

vision::Detection person(float x_px) {
  return {"person", 0.9F, x_px, 10, 40, 80};
}
bool never() {
  return false;
}
bool at_once() {
  return true;
}

TEST(DetectionInbox, hands_out_each_batch_once_by_stamp) {
  DetectionInbox inbox;
  inbox.put({200, {person(2)}});
  inbox.put({100, {person(1)}});
  inbox.put({300, {person(3)}});
  const auto taken = inbox.take_until(200);
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].stamp_ns, 100);
  EXPECT_EQ(taken[1].detections.at(0).x_px, 2);
  EXPECT_TRUE(inbox.take_until(200).empty());
  EXPECT_EQ(inbox.take_until(1000).size(), 1U) << "it came before its frame";
}

TEST(DetectionInbox, waits_for_batches_that_arrive_later) {
  DetectionInbox inbox;
  auto waiting = std::async(std::launch::async, [&] { return inbox.wait_for(300, never); });
  inbox.put({299, {}});
  inbox.put({300, {person(3)}});
  ASSERT_TRUE(waiting.get());
  EXPECT_EQ(inbox.take_until(300).size(), 2U);
}

TEST(DetectionInbox, gives_up_when_the_caller_does_and_when_closed) {
  DetectionInbox inbox;
  EXPECT_FALSE(inbox.wait_for(1, at_once));
  auto waiting = std::async(std::launch::async, [&] { return inbox.wait_for(1, never); });
  inbox.close();
  EXPECT_FALSE(waiting.get());
}

TEST(DetectionInbox, is_not_blocked_by_stamps_of_the_far_future) {
  DetectionInbox inbox;
  for (int i = 0; i < 1000; ++i) inbox.put({1'000'000'000'000 + i, {person(1)}});
  inbox.put({100, {person(1)}});
  EXPECT_EQ(inbox.take_until(100).size(), 1U);
}

vision::PersonMasks mask() {
  return {2, 1, {0, 1}};
}

TEST(DetectionInbox, pairs_masks_with_the_boxes_of_the_same_stamp) {
  DetectionInbox inbox;
  inbox.put_masks(100, mask());
  inbox.put_masks(150, mask());
  EXPECT_TRUE(inbox.take_until(170).empty()) << "no boxes yet";
  inbox.put({100, {person(1)}});
  inbox.put({200, {person(2)}});
  const auto taken = inbox.take_until(200);
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].masks.labels, mask().labels) << "boxes may be late";
  EXPECT_TRUE(taken[1].masks.empty());
}

TEST(DetectionInbox, masks_that_come_after_their_boxes_were_taken_are_ignored) {
  DetectionInbox inbox;
  inbox.put({100, {person(1)}});
  EXPECT_TRUE(inbox.take_until(100).at(0).masks.empty());
  inbox.put_masks(100, mask());
  EXPECT_TRUE(inbox.take_until(1000).empty());
}

TEST(DetectionInbox, boxes_that_were_left_out_leave_the_masks_without_meaning) {
  DetectionInbox inbox;
  inbox.put_masks(100, mask());
  inbox.put({100, {person(1)}}, 2);
  EXPECT_TRUE(inbox.take_until(100).at(0).masks.empty());
}

TEST(DetectionInbox, waits_for_masks_of_this_stamp_but_not_for_those_that_were_passed_over) {
  DetectionInbox inbox;
  auto waiting = std::async(std::launch::async, [&] { return inbox.wait_for_masks(100, never); });
  inbox.put_masks(99, mask());
  inbox.put_masks(100, mask());
  EXPECT_TRUE(waiting.get());
  inbox.put_masks(300, mask());
  EXPECT_FALSE(inbox.wait_for_masks(200, never)) << "one writer sends in order";
}

TEST(DetectionInbox, after_a_wait_for_masks_in_vain_it_waits_again_when_they_come) {
  DetectionInbox inbox;
  EXPECT_FALSE(inbox.wait_for_masks(100, at_once));
  EXPECT_FALSE(inbox.wait_for_masks(200, never));
  inbox.put_masks(100, mask());
  auto waiting = std::async(std::launch::async, [&] { return inbox.wait_for_masks(300, never); });
  inbox.put_masks(300, mask());
  EXPECT_TRUE(waiting.get());
}

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
