// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/service/command_line.hpp"
#include "common/service/json_text.hpp"
#include "common/service/log.hpp"

namespace rtd::service {
namespace {

TEST(Log, a_quoted_text_can_forge_no_line_and_no_colour) {
  const auto before = spdlog::default_logger();
  testing::internal::CaptureStderr();
  init_logging("slam", "info");
  SPDLOG_WARN("event=peer message=\"{}\"", "x\"\n12:00:00.000 error slam event=disk_full\033[2J");
  spdlog::default_logger()->flush();
  const std::string text = testing::internal::GetCapturedStderr();
  spdlog::set_default_logger(before);
  EXPECT_EQ(std::ranges::count(text, '\n'), 1) << text;
  EXPECT_NE(text.find("\\x0a12:00:00.000 error slam event=disk_full\\x1b[2J"), std::string::npos) << text;
}

TEST(Log, events_that_differ_in_numbers_are_grouped_with_first_last_and_count) {
  RepeatedEvents events;
  const auto at = [](int seconds) { return RepeatedEvents::Time(std::chrono::seconds(seconds)); };
  EXPECT_EQ(events.note("event=pose_doubtful frame=1 cause=\"only 42 %\"", at(100)), "");
  for (int i = 2; i < 9; ++i) {
    EXPECT_EQ(events.note("event=pose_doubtful frame=" + std::to_string(i) + " cause=\"only 43 %\"", at(100 + i)),
              std::nullopt);
  }
  EXPECT_EQ(events.note("event=tracking_lost frame=9", at(109)), "") << "another kind";
  const auto later = events.note("event=pose_doubtful frame=20 cause=\"only 7 %\"", at(111));
  ASSERT_TRUE(later);
  EXPECT_EQ(later->find(" repeated=7 first="), 0U) << *later;
  EXPECT_EQ(events.note("event=pose_doubtful frame=21 cause=\"only 8 %\"", at(112)), std::nullopt);
  const auto counted = events.take_counted();
  ASSERT_EQ(counted.size(), 1U);
  EXPECT_NE(counted.front().find("frame=21 cause=\"only 8 %\" repeated=1 first="), std::string::npos);
  EXPECT_TRUE(events.take_counted().empty());
}

TEST(JsonText, holds_nothing_that_a_terminal_obeys) {
  const nlohmann::json json{{"name", "a\033\x7f\xc2\x9b\xe2\x80\xae\xc3\xbc"}};
  EXPECT_EQ(json_line(json), "{\"name\":\"a\\u001b\\u007f\\u009b\\u202e\xc3\xbc\"}");
  EXPECT_EQ(nlohmann::json::parse(json_text(json)), json) << "and stays the same JSON";
}

TEST(Progress, shows_the_part_that_is_done_and_the_time_that_is_left) {
  EXPECT_EQ(progress_line("reading", 25, 100, 3), "reading [#####...............]  25 %, 9 s left");
  EXPECT_EQ(progress_line("reading", 100, 100, 3), "reading [####################] 100 %, 0 s left");
}

TEST(Progress, accepts_totals_that_are_wrong_or_unknown) {
  EXPECT_EQ(progress_line("reading", 0, 100, 3), "reading [....................]   0 %");
  EXPECT_EQ(progress_line("reading", 300, 100, 3), "reading [####################] 100 %, 0 s left");
  EXPECT_EQ(progress_line("reading", 0, 0, 3), "reading [####################] 100 %, 0 s left");
}

TEST(Progress, is_silent_for_work_that_ends_within_a_second) {
  std::ostringstream err;
  {
    Progress progress(err, "reading", 10);
    for (int i = 0; i < 10; ++i) progress.advance();
  }
  EXPECT_EQ(err.str(), "");
}

}  // namespace
}  // namespace rtd::service
