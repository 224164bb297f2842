// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/service/config.hpp"
#include "services/replay/core/message_feed.hpp"
#include "services/replay/core/player.hpp"
#include "services/replay/core/topic_choice.hpp"
#include "tests/unit/replay/played_recording.hpp"

namespace rtd::replay {
namespace {

using testing::ElementsAre;
using testing::Pair;

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(Schedule, plays_at_the_rate_from_where_it_was_put) {
  Schedule schedule(2);
  schedule.jump(100 * kSecond, 7 * kSecond);
  EXPECT_EQ(schedule.due_ns(100 * kSecond), 7 * kSecond);
  EXPECT_EQ(schedule.due_ns(110 * kSecond), 12 * kSecond);
  EXPECT_EQ(schedule.recorded_ns(12 * kSecond), 110 * kSecond);
}

TEST(Schedule, a_pause_moves_what_follows_by_its_length) {
  Schedule schedule(1);
  schedule.jump(0, 0);
  schedule.pause(3 * kSecond);
  EXPECT_EQ(schedule.recorded_ns(9 * kSecond), 3 * kSecond);
  schedule.resume(10 * kSecond);
  EXPECT_EQ(schedule.due_ns(5 * kSecond), 12 * kSecond);
}

TEST(Schedule, another_rate_counts_from_now_on) {
  Schedule schedule(1);
  schedule.jump(0, 0);
  schedule.set_rate(0.5, 4 * kSecond);
  EXPECT_EQ(schedule.recorded_ns(4 * kSecond), 4 * kSecond);
  EXPECT_EQ(schedule.due_ns(5 * kSecond), 6 * kSecond);
}

TEST(Schedule, is_exact_after_a_day) {
  Schedule schedule(1);
  schedule.jump(0, 123);
  const std::int64_t day_ns = 86'400 * kSecond;
  EXPECT_EQ(schedule.due_ns(day_ns + 1), day_ns + 124);
}

TEST(TimingError, compares_distances_so_that_a_common_delay_is_no_error) {
  TimingError error;
  for (std::int64_t i = 0; i < 100; ++i) error.add(i * 1'000'000, i * 1'000'000 + 5'000'000);
  EXPECT_EQ(error.count(), 99U);
  EXPECT_LE(error.percentile_ms(100), 0.01);
  error.add(100'000'000, 107'000'000);
  EXPECT_NEAR(error.max_ms(), 2, 1e-9);
  EXPECT_LE(error.percentile_ms(90), 0.01);
  EXPECT_NEAR(error.percentile_ms(100), 2, 0.011);
}

TEST(TimingError, an_interruption_is_not_measured) {
  TimingError error;
  error.add(0, 0);
  error.interrupt();
  error.add(1'000'000, 90'000'000);
  EXPECT_EQ(error.count(), 0U);
  EXPECT_EQ(error.percentile_ms(99), 0);
}

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

TEST(TopicChoice, plays_all_but_the_heartbeats_unless_asked) {
  EXPECT_TRUE(TopicChoice({}, {}).wants("rtd/frame"));
  EXPECT_FALSE(TopicChoice({}, {}).wants("rtd/status"));
  EXPECT_TRUE(TopicChoice({"rtd/status"}, {}).wants("rtd/status"));
}

TEST(TopicChoice, knows_the_topics_that_a_run_publishes_itself) {
  for (const char* topic : {"rtd/frame", "rtd/status", "rt/slam/pose", "rt/detector/detections"})
    EXPECT_TRUE(is_run_topic(topic)) << topic;
  for (const char* topic : {"rt/camera/color/image_raw", "rt/tf", "rt/slammed", "imu"})
    EXPECT_FALSE(is_run_topic(topic)) << topic;
}

TEST(TopicChoice, takes_patterns_on_either_spelling_of_a_name) {
  const TopicChoice choice({"/slam/*", "rt/tf"}, {"*/path"});
  EXPECT_TRUE(choice.wants("/slam/pose"));
  EXPECT_TRUE(choice.wants("/tf"));
  EXPECT_FALSE(choice.wants("/slam/path"));
  EXPECT_FALSE(choice.wants("rtd/frame"));
  EXPECT_TRUE(TopicChoice({"rt/slam/pose"}, {}).wants("/slam/pose"));
}

TEST(TopicChoice, names_the_patterns_that_meet_nothing) {
  EXPECT_THAT(TopicChoice({"/slam/*", "rtd/farme"}, {}).unmet({"/slam/pose", "rtd/frame"}), ElementsAre("rtd/farme"));
}

TEST(TopicChoice, patterns_may_leave_out_the_name_of_a_robot) {
  const TopicChoice choice({"/slam/*", "rtd/frame"}, {}), all({}, {});
  EXPECT_TRUE(choice.wants("/anna/slam/pose"));
  EXPECT_TRUE(choice.wants("rtd/anna/frame"));
  EXPECT_FALSE(choice.wants("rtd/anna/features"));
  EXPECT_FALSE(all.wants("rtd/anna/status")) << "heartbeats, as those of a robot without a name";
  EXPECT_TRUE(is_run_topic("rtd/anna/frame"));
  EXPECT_TRUE(is_run_topic("rt/anna/slam/pose"));
}

TEST(Remap, takes_both_spellings) {
  EXPECT_THAT(parse_remaps({"/slam/pose:=/old/pose", "rtd/frame:=rtd/frame2"}),
              ElementsAre(Pair("rt/slam/pose", "rt/old/pose"), Pair("rtd/frame", "rtd/frame2")));
}

TEST(Remap, refuses_what_is_no_renaming) {
  for (const char* wrong : {"/a", "/a:/b", ":=/b", "/a:=", "/a b:=/c", "/a*:=/b"})
    EXPECT_THROW(parse_remaps({wrong}), service::ConfigError) << wrong;
  EXPECT_THROW(parse_remaps({"/a:=/b", "rt/a:=/c"}), service::ConfigError);
}

std::vector<Command> typed(const std::string& bytes) {
  KeyCommands keys;
  std::vector<Command> commands;
  for (const char byte : bytes)
    if (const auto command = keys.next(byte)) commands.push_back(*command);
  return commands;
}

TEST(KeyCommands, knows_the_keys_of_rosbag2) {
  EXPECT_THAT(typed(" \x1b[C\x1b[A\x1b[B"),
              testing::ElementsAre(Command::kTogglePause, Command::kStep, Command::kFaster, Command::kSlower));
  EXPECT_THAT(typed("sbfq"), testing::ElementsAre(Command::kStep, Command::kBack, Command::kForward, Command::kStop));
}

TEST(KeyCommands, takes_no_part_of_another_sequence_for_a_key) {
  EXPECT_THAT(typed("\x1b[5~"), testing::IsEmpty()) << "page up";
  EXPECT_THAT(typed("\x1b[1;5C"), testing::ElementsAre(Command::kStep)) << "with control";
  EXPECT_THAT(typed("\x1bOC"), testing::ElementsAre(Command::kStep)) << "application mode";
  EXPECT_THAT(typed("\x1b\x1b[A"), testing::ElementsAre(Command::kFaster));
  EXPECT_THAT(typed("xyz\x7f"), testing::IsEmpty());
}

}  // namespace
}  // namespace rtd::replay
