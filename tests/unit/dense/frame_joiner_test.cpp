// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/dense/frame_joiner.hpp"

namespace rtd::dense {
namespace {

using ::testing::IsEmpty;

constexpr std::chrono::milliseconds kNow{0};

std::int64_t stamp(std::uint64_t seq) {
  return static_cast<std::int64_t>(seq) * 1000 + 5;
}

class FrameJoinerTest : public testing::Test {
 protected:
  void image(std::uint64_t seq) {
    auto frame = std::make_shared<msg::RgbdFrame>();
    frame->seq = seq;
    frame->stamp_ns = stamp(seq);
    joiner_.put(std::make_shared<const msg::FrameView>(*frame, frame));
  }
  void mask(std::uint64_t seq) { joiner_.put(stamp(seq), all_static()); }
  void pose(std::uint64_t seq, std::uint64_t events = 0, msg::TrackingState state = msg::TrackingState::kOk) {
    msg::TrackingResult result{};
    result.seq = seq;
    result.stamp_ns = stamp(seq);
    result.event_count = events;
    result.state = state;
    joiner_.put(result);
  }
  void event(std::uint64_t index, std::uint64_t frame_seq = 0) {
    msg::KeyframeEvent event{};
    event.event_index = index;
    event.frame_seq = frame_seq;
    joiner_.put(event);
  }
  /// The seq of the next frame, -1 when none is ready.
  std::int64_t next() {
    const auto joined = joiner_.take(kNow);
    return joined ? static_cast<std::int64_t>(joined->result.seq) : -1;
  }

  FrameJoiner joiner_{{.every = 2, .needs_masks = true}};
};

TEST_F(FrameJoinerTest, gives_a_frame_when_all_three_parts_are_there_in_any_order) {
  pose(0);
  EXPECT_EQ(next(), -1);
  image(0);
  EXPECT_EQ(next(), -1);
  mask(0);
  EXPECT_EQ(next(), 0);
  EXPECT_EQ(next(), -1) << "once";
  pose(0);
  EXPECT_EQ(next(), -1) << "a repeated answer";
}

TEST_F(FrameJoinerTest, takes_every_second_frame_and_keyframes) {
  event(0, 3);
  for (std::uint64_t seq = 1; seq < 5; ++seq) {
    image(seq);
    mask(seq);
    pose(seq, 1);
  }
  EXPECT_EQ(next(), 2);
  EXPECT_EQ(next(), 3) << "a keyframe";
  EXPECT_EQ(next(), 4);
  EXPECT_EQ(joiner_.counters().passed_over, 1U);
}

TEST_F(FrameJoinerTest, waits_for_the_keyframe_events_before_a_result) {
  image(0);
  mask(0);
  pose(0, 2);
  event(0);
  EXPECT_EQ(next(), -1);
  event(1);
  event(2);
  const auto joined = joiner_.take(kNow);
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->updates.size(), 2U) << "the third came after the frame";
  EXPECT_EQ(joiner_.take_updates().size(), 1U);
}

TEST_F(FrameJoinerTest, drops_a_frame_whose_mask_does_not_come) {
  for (std::uint64_t seq = 2; seq < 14; ++seq) {
    image(seq);
    pose(seq);
  }
  mask(8);
  EXPECT_EQ(next(), 8);
  EXPECT_EQ(joiner_.counters().without_mask, 3U);
}

TEST_F(FrameJoinerTest, does_without_masks_when_configured) {
  FrameJoiner joiner({.every = 1, .needs_masks = false});
  auto frame = std::make_shared<msg::RgbdFrame>();
  joiner.put(std::make_shared<const msg::FrameView>(*frame, frame));
  msg::TrackingResult result{};
  result.state = msg::TrackingState::kOk;
  joiner.put(result);
  joiner.close();
  const auto joined = joiner.take(kNow);
  ASSERT_TRUE(joined);
  EXPECT_FALSE(joined->mask);
}

TEST_F(FrameJoinerTest, counts_frames_without_pose) {
  image(0);
  mask(0);
  pose(0, 0, msg::TrackingState::kLost);
  EXPECT_EQ(next(), -1);
  EXPECT_EQ(joiner_.counters().not_tracked, 1U);
}

TEST_F(FrameJoinerTest, leaves_out_frames_of_another_map) {
  msg::TrackingResult result{};
  result.state = msg::TrackingState::kOk;
  result.map_id = 1;
  image(0);
  mask(0);
  joiner_.put(result);
  EXPECT_EQ(next(), -1);
  EXPECT_EQ(joiner_.counters().not_tracked, 1U);
  EXPECT_TRUE(joiner_.elsewhere());
  pose(1, 0, msg::TrackingState::kLost);
  EXPECT_TRUE(joiner_.elsewhere()) << "a lost camera is where it was";
  pose(2);
  EXPECT_FALSE(joiner_.elsewhere());
}

TEST_F(FrameJoinerTest, keeps_the_newest_images_when_none_is_taken) {
  for (std::uint64_t seq = 0; seq < 400; ++seq) {
    image(seq);
    mask(seq);
    pose(seq);
  }
  std::int64_t first = next(), last = first;
  for (std::int64_t seq = first; seq >= 0; seq = next()) last = seq;
  EXPECT_GE(first, 388);
  EXPECT_EQ(last, 398);
  const JoinCounters counters = joiner_.counters();
  EXPECT_GE(counters.without_image, 120U) << "every one that was lost is counted";
}

TEST_F(FrameJoinerTest, takes_stamps_that_go_back) {
  for (const std::uint64_t seq : {100U, 102U, 2U, 4U}) {
    image(seq);
    mask(seq);
    pose(seq);
  }
  for (const std::int64_t seq : {100, 102, 2, 4}) EXPECT_EQ(next(), seq);
}

TEST_F(FrameJoinerTest, notices_that_slam_was_restarted) {
  for (std::uint64_t i = 0; i < 5; ++i) event(i, i);
  image(0);
  mask(0);
  pose(0, 5);
  EXPECT_EQ(next(), 0);
  event(0, 10);
  image(10);
  mask(10);
  pose(10, 1);
  const auto joined = joiner_.take(kNow);
  ASSERT_TRUE(joined);
  ASSERT_EQ(joined->updates.size(), 1U);
  EXPECT_TRUE(joined->updates[0].new_map);
}

TEST_F(FrameJoinerTest, ends_a_wait_when_closed) {
  pose(0);
  joiner_.close();
  EXPECT_FALSE(joiner_.take(std::chrono::hours(1)));
  EXPECT_EQ(joiner_.counters().without_image, 1U);
}

msg::KeyframeEvent event_of(std::int64_t stamp_ns, msg::KeyframeEventKind kind = msg::KeyframeEventKind::kCreated) {
  msg::KeyframeEvent event{};
  event.stamp_ns = stamp_ns;
  event.kind = kind;
  return event;
}

TEST(KeyframeMasks, are_found_whichever_comes_first_and_given_once) {
  KeyframeMasks masks;
  masks.put(1, all_static());
  masks.put(2, all_static());
  masks.put(event_of(1));
  masks.put(event_of(3));
  masks.put(event_of(2, msg::KeyframeEventKind::kCorrected));
  masks.put(3, {1, 1, {DynamicMask::kDynamic}});
  const auto found = masks.take();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found.at(1).cells.at(0), DynamicMask::kStatic);
  EXPECT_EQ(found.at(3).cells.at(0), DynamicMask::kDynamic);
  EXPECT_THAT(masks.take(), IsEmpty());
}

TEST(KeyframeMasks, keeps_only_the_newest_frames) {
  KeyframeMasks masks;
  for (std::size_t i = 0; i <= KeyframeMasks::kRecent; ++i) masks.put(static_cast<std::int64_t>(i), all_static());
  masks.put(event_of(0));
  masks.put(event_of(1));
  EXPECT_EQ(masks.take().count(1), 1U);
  EXPECT_THAT(masks.take(), IsEmpty());
}

}  // namespace
}  // namespace rtd::dense
