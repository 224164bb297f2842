// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::io {

/// A line of a text file without its comment and line end, split at separators; lines left empty are not kept.
struct TextLine {
  int number = 0;  ///< counts from 1
  std::vector<std::string> fields;
};

/// Splits a text into lines and fields; '#' starts a comment, a byte order mark at the beginning is passed over.
std::vector<TextLine> split_lines(std::string_view text, std::string_view separators = " \t\r\v\f");

/// std::getline() for files of others: false also for a line of more than 64 KiB.
bool get_line(std::istream& in, std::string& line);

/// The whole text as a number; empty when it is not one. "nan" and "inf" are numbers here: check them.
std::optional<double> parse_number(std::string_view text);

/// The text with '#' in place of each number that stands alone: what events of one kind have in common.
std::string without_numbers(std::string_view text);

/// The candidate with the smallest edit distance to `name`; empty when none is near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// A number that cannot be a time: not finite, or too large for nanoseconds in 64 bits.
class StampOutOfRange : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Decimal seconds -> ns, exact to the last digit. Throws std::invalid_argument for a text that is not a number.
std::int64_t parse_stamp_ns(const std::string& text);

}  // namespace rtd::io
