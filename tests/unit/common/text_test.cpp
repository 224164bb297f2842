// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/text.hpp"

#include <gmock/gmock.h>

namespace rtd::io {
namespace {

using ::testing::ElementsAre;

TEST(Text, without_numbers_keeps_names_that_have_digits) {
  EXPECT_EQ(without_numbers("event=late frame=12 ms=3.5 topic=/cam1 \"42 %\""),
            "event=late frame=# ms=# topic=/cam1 \"# %\"");
}

TEST(ParseStamp, is_exact_to_the_nanosecond) {
  EXPECT_EQ(parse_stamp_ns("1305031102.175304"), 1305031102175304000);
  EXPECT_EQ(parse_stamp_ns("1341846313.6541841"), 1341846313654184100);
  EXPECT_EQ(parse_stamp_ns("1341846313.123456789"), 1341846313123456789);
  EXPECT_EQ(parse_stamp_ns("0.000000001"), 1);
  EXPECT_EQ(parse_stamp_ns("12"), 12'000'000'000);
  EXPECT_EQ(parse_stamp_ns(".5"), 500'000'000);
  EXPECT_EQ(parse_stamp_ns("-1.5"), -1'500'000'000);
  EXPECT_EQ(parse_stamp_ns("1e2"), 100'000'000'000);
  EXPECT_EQ(parse_stamp_ns("1.5e3"), 1'500'000'000'000);
}

TEST(ParseStamp, distinguishes_numbers_that_are_no_times_from_other_texts) {
  EXPECT_THROW(parse_stamp_ns("12:30"), std::invalid_argument);
  for (const char* text : {"nan", "inf", "-inf", "1e300"}) EXPECT_THROW(parse_stamp_ns(text), StampOutOfRange);
}

TEST(SplitLines, leaves_out_comments_and_blank_lines) {
  const std::vector<TextLine> lines = split_lines("# title\n\n a\tb # rest\r\n\r\nc");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].number, 3);
  EXPECT_THAT(lines[0].fields, ElementsAre("a", "b"));
  EXPECT_EQ(lines[1].number, 5);
  EXPECT_THAT(lines[1].fields, ElementsAre("c"));
}

TEST(NearestName, finds_a_typo_and_nothing_far_away) {
  EXPECT_EQ(nearest_name("hole", {"seed", "holes"}), "holes");
  EXPECT_EQ(nearest_name("zebra", {"seed", "holes"}), "");
}

}  // namespace
}  // namespace rtd::io
