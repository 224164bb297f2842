// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::camera {

/// A line of a text file without its comment and line end, split at blanks; lines left empty are not kept.
struct TextLine {
  int number = 0;  ///< counts from 1
  std::vector<std::string> fields;
};

/// Reads a text file; '#' starts a comment. Throws SourceError when it cannot be read.
std::vector<TextLine> read_lines(const std::filesystem::path& file);
std::vector<TextLine> split_lines(const std::string& text);

/// The whole text as a number; empty when it is none. "nan" and "inf" are numbers here: check them.
std::optional<double> parse_number(const std::string& text);

/// Decimal seconds -> ns, exact to the last digit. Throws SourceError for what is finite no number (nan, inf) naming
/// `where`; empty when the text is no number at all.
std::optional<std::int64_t> parse_stamp_ns(const std::string& text, const std::string& where);

/// "folder/rgb.txt:17": for messages.
std::string at_line(const std::filesystem::path& file, int line);

}  // namespace rtd::camera
