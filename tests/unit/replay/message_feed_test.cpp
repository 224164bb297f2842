// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/message_feed.hpp"

#include <gtest/gtest.h>

#include "tests/unit/replay/played_recording.hpp"

namespace rtd::replay {
namespace {

FeedOptions everything() {
  FeedOptions options;
  options.end_ns = 1'000'000 * kMillisecond;
  return options;
}

TEST(MessageFeed, gives_all_messages_of_the_span_in_order) {
  PlayedRecording recording(numbered(100));
  FeedOptions options = everything();
  options.start_ns = 1200 * kMillisecond;
  options.end_ns = 1500 * kMillisecond;
  options.read_ahead_bytes = 10;
  MessageFeed feed(recording.reader(), options);
  for (int i = 20; i <= 50; ++i) EXPECT_EQ(text_of(*feed.next()->cdr), std::to_string(i));
  EXPECT_FALSE(feed.next());
}

TEST(MessageFeed, a_seek_forgets_what_was_read_ahead) {
  PlayedRecording recording(numbered(100));
  MessageFeed feed(recording.reader(), everything());
  EXPECT_EQ(text_of(*feed.next()->cdr), "0");
  feed.seek(1705 * kMillisecond);
  EXPECT_EQ(text_of(*feed.next()->cdr), "71");
  feed.seek(0);
  EXPECT_EQ(text_of(*feed.next()->cdr), "0");
}

TEST(MessageFeed, begins_again_behind_its_end) {
  PlayedRecording recording(numbered(3));
  MessageFeed feed(recording.reader(), everything());
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(text_of(*feed.next()->cdr), std::to_string(i));
    EXPECT_FALSE(feed.next());
    feed.seek(0);
  }
}

TEST(MessageFeed, ends_while_it_waits_for_room) {
  PlayedRecording recording(numbered(100));
  FeedOptions options = everything();
  options.read_ahead_bytes = 1;
  MessageFeed feed(recording.reader(), options);
  EXPECT_TRUE(feed.next());
}

}  // namespace
}  // namespace rtd::replay
