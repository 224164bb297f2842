// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>

#include "common/service/command_line.hpp"

namespace rtd::service {
namespace {

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
