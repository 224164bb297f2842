// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/printable.hpp"

#include <algorithm>
#include <iostream>

#include "common/io/utf8.hpp"

namespace rtd::io {
namespace {

/// Bytes at the begin of the text that can be shown.
std::size_t shown_bytes(std::string_view text, LineEnds line_ends) {
  std::size_t shown = 0;
  while (shown < text.size()) {
    const Utf8Character character = first_character(text.substr(shown));
    const bool kept = line_ends == LineEnds::kKeep && (character.code == '\n' || character.code == '\t');
    const bool hidden = is_control(character.code) || is_disguise(character.code);
    if (character.bytes == 0 || (hidden && !kept)) break;
    shown += character.bytes;
  }
  return shown;
}

void append_escaped(std::string& output, std::string_view bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    output += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
}

}  // namespace

std::string printable(std::string_view text, LineEnds line_ends) {
  std::string output;
  while (!text.empty()) {
    const std::size_t shown = shown_bytes(text, line_ends);
    output += text.substr(0, shown);
    text.remove_prefix(shown);
    const std::size_t hidden = std::min(std::max<std::size_t>(1, first_character(text).bytes), text.size());
    append_escaped(output, text.substr(0, hidden));
    text.remove_prefix(hidden);
  }
  return output;
}

bool is_printable(std::string_view text, LineEnds line_ends) {
  return shown_bytes(text, line_ends) == text.size();
}

std::string abridged(std::string_view value, std::size_t longest) {
  if (value.size() <= longest) return std::string(value);
  const auto inside = [&](std::size_t place) { return (static_cast<unsigned char>(value[place]) & 0xc0U) == 0x80; };
  std::size_t begin = longest / 2, end = value.size() - longest / 4;
  while (begin > 0 && inside(begin)) --begin;
  while (end < value.size() && inside(end)) ++end;
  return std::string(value.substr(0, begin)) + " [" + std::to_string(value.size()) + " bytes] " +
         std::string(value.substr(end));
}

PrintableBuf::int_type PrintableBuf::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
  const char character = traits_type::to_char_type(c);
  return xsputn(&character, 1) == 1 ? c : traits_type::eof();
}

std::streamsize PrintableBuf::xsputn(const char* text, std::streamsize size) {
  const std::string_view added(text, static_cast<std::size_t>(size));
  const std::lock_guard lock(mutex_);
  line_ += added;
  return added.find('\n') == std::string_view::npos || pass_on() ? size : 0;
}

int PrintableBuf::sync() {
  const std::lock_guard lock(mutex_);
  return pass_on() ? 0 : -1;
}

bool PrintableBuf::pass_on() {
  std::string shown;
  for (std::string_view rest = line_; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    shown += abridged(printable(line, LineEnds::kKeep), longest_line_);
    if (line.data() + line.size() != line_.data() + line_.size()) shown += '\n';
  }
  line_.clear();
  const auto size = static_cast<std::streamsize>(shown.size());
  return target_.sputn(shown.data(), size) == size && target_.pubsync() == 0;
}

void rewrite_terminal_line(std::string_view text) {
  std::clog << "\r\033[K" << printable(text) << '\r' << std::flush;  // a log line overwrites it
}

}  // namespace rtd::io
