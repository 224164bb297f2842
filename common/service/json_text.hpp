// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "common/io/utf8.hpp"

namespace rtd::service {

/// Escapes what dump() leaves as it is and a terminal would obey or hide (io::is_control(), io::is_disguise()): only
/// texts hold such characters.
inline std::string escape_controls(const std::string& json) {
  const auto harmless = [](char c) { return (c >= ' ' && c <= '~') || c == '\n'; };
  if (std::ranges::all_of(json, harmless)) return json;
  std::string escaped;
  for (std::string_view rest = json; !rest.empty();) {
    const io::Utf8Character character = io::first_character(rest);
    const std::size_t bytes = std::max<std::size_t>(1, character.bytes);
    const bool line_end = character.code == '\n';
    if (!line_end && (io::is_control(character.code) || io::is_disguise(character.code))) {
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\u%04x", static_cast<std::uint16_t>(character.code));
      escaped += code.data();
    } else {
      escaped += rest.substr(0, bytes);
    }
    rest.remove_prefix(bytes);
  }
  return escaped;
}

/// A value of nlohmann's JSON as the tools print it. Names and texts from files of other programs need not be UTF-8:
/// each of their invalid bytes becomes U+FFFD, where dump() alone throws.
template <class Json>
std::string json_text(const Json& json) {
  return escape_controls(json.dump(2, ' ', false, Json::error_handler_t::replace));
}

/// The same on one line.
template <class Json = nlohmann::json>
std::string json_line(const Json& json) {
  return escape_controls(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace rtd::service
