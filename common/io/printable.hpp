// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace rtd::io
