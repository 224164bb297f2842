// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <sstream>

#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/service/standard_streams.hpp"

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

namespace rtd::io {
namespace {

TEST(Printable, leaves_text_of_any_language_as_it_is) {
  for (const char* text : {"", "event=late frame=7", "\xc3\xbc", "\xe2\x9c\x93 done", "\xf0\x9f\x99\x82"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_TRUE(is_printable(text));
  }
}

TEST(Printable, escapes_what_a_terminal_obeys) {
  EXPECT_EQ(printable("a\033[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(printable("a\nlevel=info"), "a\\x0alevel=info");
  EXPECT_EQ(printable("\r\t\x7f"), "\\x0d\\x09\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\xc2\\x9b31m")
      << "C1, a control sequence without ESC";
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(Printable, escapes_what_disguises_a_line) {
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "abc"),
            "\\xe2\\x80\\xaeabc")
      << "right to left";
  EXPECT_EQ(printable("\xe2\x80\xa8"), "\\xe2\\x80\\xa8") << "line separator";
}

TEST(Printable, escapes_what_is_not_utf8) {
  EXPECT_EQ(printable("\xff"), "\\xff");
  EXPECT_EQ(printable("\xc3"), "\\xc3") << "cut off";
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "overlong";
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a pair";
  EXPECT_FALSE(is_printable("\xff"));
}

TEST(Printable, keeps_line_ends_on_request) {
  EXPECT_EQ(printable("a\n\tb\r", LineEnds::kKeep), "a\n\tb\\x0d");
}

TEST(Abridged, shows_both_ends_of_a_long_value_and_its_size) {
  EXPECT_EQ(abridged(std::string(120, 'x')), std::string(120, 'x'));
  const std::string shown = abridged("begin" + std::string(99'990, ' ') + "end");
  EXPECT_TRUE(shown.starts_with("begin ") && shown.ends_with(" end")) << shown;
  EXPECT_NE(shown.find(" [99998 bytes] "), std::string::npos);
  EXPECT_LE(shown.size(), 120U);
}

TEST(Abridged, cuts_no_character_in_two) {
  for (std::size_t before = 0; before < 3; ++before) {
    std::string text(before, 'x');
    for (int i = 0; i < 100; ++i) text += "\xe2\x9c\x93";
    EXPECT_TRUE(is_printable(abridged(text)));
  }
}

TEST(PrintableOutput, filters_a_stream_as_long_as_it_lives) {
  std::ostringstream out;
  {
    const PrintableOutput filter(out);
    out << "topic " << '\xc3' << '\xbc' << "\033[31m" << '\n' << "rest\x07";
    EXPECT_EQ(out.str(), "topic \xc3\xbc\\x1b[31m\n") << "a line at a time";
  }
  EXPECT_EQ(out.str(), "topic \xc3\xbc\\x1b[31m\nrest\\x07");
  out << '\033';
  EXPECT_TRUE(out.str().ends_with('\033'));
}

TEST(PrintableOutput, lines_may_have_a_longest_size) {
  std::ostringstream out;
  {
    const PrintableOutput filter(out, 100);
    out << "short\n\n" << std::string(5000, 'x') << "\nlast";
  }
  const std::string text = out.str();
  EXPECT_TRUE(text.starts_with("short\n\nxxx") && text.ends_with("xxx\nlast")) << text;
  EXPECT_LT(text.size(), 120U);
}

}  // namespace
}  // namespace rtd::io

namespace rtd::service {
namespace {

/// The status of a child that does this.
int status_of(const auto& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(StandardStreams, a_file_never_gets_the_number_of_a_closed_stream) {
  const int status = status_of([] {
    ::close(STDERR_FILENO);
    ::close(STDIN_FILENO);
    prepare_standard_streams();
    const int file = ::open("/dev/zero", O_RDONLY);
    return file > STDERR_FILENO && ::write(STDERR_FILENO, "x", 1) == 1 ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
}

TEST(StandardStreams, output_without_a_reader_ends_no_process) {
  const int status = status_of([] {
    int ends[2];
    if (::pipe(ends) != 0) return 2;
    ::close(ends[0]);
    outlive_readers();
    return ::write(ends[1], "x", 1) < 0 ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace rtd::service
