// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_command.hpp"

#include <gmock/gmock.h>

namespace rtd::launcher {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

run_record::RunRecord run_of(std::uint64_t frames_in, std::uint64_t left_out) {
  run_record::RunRecord record;
  record.frames_in = frames_in;
  record.frames_left_out = left_out;
  return record;
}

TEST(WhyNotUsed, names_the_commonest_reason_its_remedy_and_an_example) {
  run_record::RunRecord record = run_of(4, 5);
  record.left_out = {{"stamp_backwards", 4}, {"malformed_line", 1}};
  const std::string why = why_not_used(record, "rgb/3.jpg is older than the frame before");
  EXPECT_THAT(why, StartsWith("only 4 of 9 frames were used; 4 x stamp_backwards: stamps are older than those before"));
  EXPECT_THAT(why, HasSubstr("give each frame its time in seconds"));
  EXPECT_THAT(why, HasSubstr("(first left out: rgb/3.jpg is older than the frame before)"));
}

TEST(WhyNotUsed, has_nothing_to_say_when_nine_of_ten_frames_were_used) {
  EXPECT_THAT(why_not_used(run_of(9, 1), ""), IsEmpty());
  EXPECT_THAT(why_not_used(run_of(0, 0), ""), IsEmpty());
}

TEST(WhyNotUsed, names_causes_behind_the_source_too) {
  run_record::RunRecord record = run_of(10, 0);
  record.frames_out_of_range = 9;
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("9 x out_of_range: no pixel has a depth between 0.1 and 20 m"));
  record = run_of(20, 0);
  record.frames_not_played = 80;
  EXPECT_THAT(why_not_used(record, ""), StartsWith("only 20 of 100 frames were used; 80 x not_played: the run ended"));
  record = run_of(10, 0);
  record.frames_dropped = 8;
  record.drops["camera.late"] = 7;
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("7 x late: they came too late for pace realtime: --pace lockstep"));
  record.drops["camera.late"] = 1;
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("7 x without_answer: slam gave no result"));
}

TEST(WhyNotUsed, frames_that_a_service_took_with_it_are_its_fault_however_few) {
  run_record::RunRecord record = run_of(200, 0);
  record.processes["camera"] = {.restarts = 5, .deaths = 5, .died = "died: killed by signal 9 (SIGKILL)"};
  EXPECT_FALSE(died_with_frames(record)) << "it continued where it was";
  EXPECT_THAT(why_not_used(record, ""), IsEmpty());
  record.frames_dropped = record.drops["camera.late"] = 12;
  EXPECT_TRUE(died_with_frames(record));
  EXPECT_EQ(why_not_used(record, ""),
            "only 188 of 200 frames were used: camera died: killed by signal 9 (SIGKILL) (5 times)");
  record.processes["detector"] = record.processes["camera"];
  record.processes.erase("camera");
  EXPECT_FALSE(died_with_frames(record)) << "a frame needs no detector";
}

TEST(WhyNotUsed, a_second_camera_on_the_topic_is_named_however_few_its_images) {
  run_record::RunRecord record = run_of(198, 2);
  EXPECT_FALSE(is_partial(record));
  record.left_out = {{"other_camera", 2}};
  EXPECT_TRUE(is_partial(record));
  EXPECT_THAT(why_not_used(record, ""), HasSubstr("2 x other_camera: two cameras send on one topic"));
}

TEST(WhyNotUsed, what_a_running_camera_did_not_give_while_it_was_dead_is_missing) {
  run_record::RunRecord record = run_of(200, 0);
  record.processes["camera"] = {.restarts = 1, .deaths = 1, .died = "died: exit code 1"};
  record.source = "ros2:/color,/depth";
  EXPECT_TRUE(died_with_frames(record));
}

}  // namespace
}  // namespace rtd::launcher
