// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/trace.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::service {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(JournalFieldsTest, every_key_is_a_field) {
  EXPECT_THAT(journal_fields("event=frame_late frame=12 cause=\"the host is busy\" p99_ms=3.5"),
              ElementsAre("RTD_EVENT=frame_late", "RTD_FRAME=12", "RTD_CAUSE=the host is busy", "RTD_P99_MS=3.5"));
}

TEST(JournalFieldsTest, the_rest_of_a_line_is_left_out) {
  EXPECT_THAT(journal_fields(""), IsEmpty());
  EXPECT_THAT(journal_fields("only words"), IsEmpty());
  EXPECT_THAT(journal_fields("messages: rt/tf=4 event=passed"), ElementsAre("RTD_EVENT=passed"));
  EXPECT_THAT(journal_fields("cause=\"not closed"), ElementsAre("RTD_CAUSE=not closed"));
  EXPECT_THAT(journal_fields("=x a="), ElementsAre("RTD_A="));
}

TEST(JournalSinkTest, knows_the_journal_by_the_stream_that_systemd_names) {
  struct stat file {};
  ASSERT_EQ(fstat(STDERR_FILENO, &file), 0);
  const std::string own = std::to_string(file.st_dev) + ":" + std::to_string(file.st_ino);
  EXPECT_FALSE(stderr_is_journal());
  setenv("JOURNAL_STREAM", own.c_str(), 1);
  EXPECT_TRUE(stderr_is_journal());
  setenv("JOURNAL_STREAM", "1:1", 1);
  EXPECT_FALSE(stderr_is_journal());
  unsetenv("JOURNAL_STREAM");
}

namespace fs = std::filesystem;

class TraceTest : public ::testing::Test {
 protected:
  std::vector<nlohmann::json> written() const {
    std::vector<nlohmann::json> events;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      std::ifstream lines(entry.path());
      for (std::string line; std::getline(lines, line);) events.push_back(nlohmann::json::parse(line));
    }
    return events;
  }

  const rtd::test::TemporaryFolder folder_;
};

TEST_F(TraceTest, writes_spans_of_frames_in_microseconds) {
  { Trace(folder_.path(), "slam").span("pose", 5'000, 7'500, 12); }
  const auto events = written();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0]["args"]["name"], "rtd-slam");
  EXPECT_EQ(events[1]["ph"], "X");
  EXPECT_EQ(events[1]["ts"], 5.0);
  EXPECT_EQ(events[1]["dur"], 2.5);
  EXPECT_EQ(events[1]["pid"], getpid());
  EXPECT_EQ(events[1]["args"]["frame"], 12);
}

TEST_F(TraceTest, stages_follow_one_another_and_those_without_time_are_left_out) {
  {
    const std::vector<TraceStage> stages = {{"a", 1}, {"b", 0}, {"c", 2}};
    Trace(folder_.path(), "slam").stages(1'000'000, stages, 3);
  }
  const auto events = written();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[1]["ts"], 1000.0);
  EXPECT_EQ(events[2]["name"], "c");
  EXPECT_EQ(events[2]["ts"], 2000.0);
}

TEST_F(TraceTest, ways_may_overlap_so_each_has_an_id) {
  { Trace(folder_.path(), "slam").async_span("camera to pose", 1'000, 3'000, 4); }
  const auto events = written();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[1]["ph"], "b");
  EXPECT_EQ(events[2]["ph"], "e");
  EXPECT_EQ(events[1]["id"], events[2]["id"]);
}

TEST_F(TraceTest, a_span_lasts_as_long_as_its_object) {
  const std::int64_t before_ns = monotonic_ns();
  {
    Trace trace(folder_.path(), "dense");
    const TraceSpan span(trace, "fuse", 1);
  }
  const auto events = written();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_GE(events[1]["ts"].get<double>() * 1e3, static_cast<double>(before_ns) - 1e3);
  EXPECT_LT(events[1]["dur"], 1e6);
}

TEST_F(TraceTest, writes_nothing_without_a_folder_or_into_one_that_is_not_there) {
  Trace::none().span("a", 0, 1, 0);
  EXPECT_FALSE(Trace("", "slam").on());
  EXPECT_FALSE(Trace(folder_ / "none", "slam").on());
  EXPECT_TRUE(written().empty());
}

}  // namespace
}  // namespace rtd::service
