// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace rtd::io {

/// What printable() leaves as it is.
enum class LineEnds { kEscape, kKeep };

/// Text from outside as a terminal or a log may show it: control characters, line ends, what is not UTF-8 and
/// characters that disguise a line become "\x1b", "\xe2\x80\xae" and so on, byte by byte. Such a text cannot end its
/// line, move the cursor or change colours.
std::string printable(std::string_view text, LineEnds line_ends = LineEnds::kEscape);

/// Whether printable() would return the text as it is.
bool is_printable(std::string_view text, LineEnds line_ends = LineEnds::kEscape);

/// A value from outside as an error quotes it: at most 120 characters, of a longer one both ends and its size.
std::string abridged(std::string_view value, std::size_t longest = 120);

/// Passes text on line by line, made printable; line ends stay. Thread-safe.
class PrintableBuf : public std::streambuf {
 public:
  /// Longer lines are abridged().
  PrintableBuf(std::streambuf& target, std::size_t longest_line) : target_(target), longest_line_(longest_line) {}
  ~PrintableBuf() override { sync(); }

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int sync() override;

 private:
  bool pass_on();

  std::streambuf& target_;
  const std::size_t longest_line_;
  std::mutex mutex_;
  std::string line_;  ///< a character may come in parts
};

/// Puts a text, made printable, in place of the last line of the terminal at stderr; "" clears that line. What goes
/// through PrintableOutput cannot do that.
void rewrite_terminal_line(std::string_view text);

/// While it lives, all that is written to a stream is printable.
class PrintableOutput {
 public:
  explicit PrintableOutput(std::ostream& stream, std::size_t longest_line = std::string::npos)
      : stream_(stream), target_(*stream.rdbuf()), buffer_(target_, longest_line) {
    stream.rdbuf(&buffer_);
  }
  ~PrintableOutput() { stream_.flush().rdbuf(&target_); }
  PrintableOutput(const PrintableOutput&) = delete;
  PrintableOutput& operator=(const PrintableOutput&) = delete;

 private:
  std::ostream& stream_;
  std::streambuf& target_;
  PrintableBuf buffer_;
};

}  // namespace rtd::io
