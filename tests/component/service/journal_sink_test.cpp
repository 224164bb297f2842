// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/log.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

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

}  // namespace
}  // namespace rtd::service
