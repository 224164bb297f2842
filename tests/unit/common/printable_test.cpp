// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/printable.hpp"

#include <gtest/gtest.h>

#include <sstream>

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
