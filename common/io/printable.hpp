// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Passes text on line by line, made printable; line ends stay.
class PrintableBuf : public std::streambuf {
 public:
  explicit PrintableBuf(std::streambuf& target) : target_(target) {}
  ~PrintableBuf() override { sync(); }

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int sync() override;

 private:
  std::streambuf& target_;
  std::string line_;  ///< a character may come in parts
};

/// While it lives, all that is written to a stream is printable.
class PrintableOutput {
 public:
  explicit PrintableOutput(std::ostream& stream) : stream_(stream), target_(*stream.rdbuf()), buffer_(target_) {
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
