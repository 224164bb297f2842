// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <map>
#include <string>

/// How rmw_cyclonedds and rmw_fastrtps of Iron and later read the USER_DATA of an endpoint that they discover.
namespace rtd::testing {

enum class UserData {
  kHash,
  kNoHash,   ///< accepted silently, with a hash of zeros
  kWarning,  ///< "Failed to parse type hash for topic ..."
};

/// "key=value;" repeated: keys of letters and digits, values that are not empty. Anything else gives an empty list.
inline std::map<std::string, std::string> parse_key_values(const std::string& text) {
  std::map<std::string, std::string> values;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t equals = text.find('=', at);
    const std::size_t end = std::min(text.find(';', equals == std::string::npos ? at : equals), text.size());
    if (equals == std::string::npos || end <= equals + 1) return {};
    const std::string key = text.substr(at, equals - at);
    if (key.empty() || !std::ranges::all_of(key, [](unsigned char c) { return std::isalnum(c) != 0; })) return {};
    values[key] = text.substr(equals + 1, end - equals - 1);
    at = end + 1;
  }
  return values;
}

/// Without USER_DATA the RMW gets a null pointer, which its parser refuses.
inline UserData parse_user_data(const std::string& user_data) {
  if (user_data.empty()) return UserData::kWarning;
  const auto values = parse_key_values(user_data);
  const auto hash = values.find("typehash");
  if (hash == values.end()) return UserData::kNoHash;
  const std::string& text = hash->second;
  const bool right = text.starts_with("RIHS01_") && text.size() == 7 + 64 &&
                     std::all_of(text.begin() + 7, text.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
  return right ? UserData::kHash : UserData::kWarning;
}

}  // namespace rtd::testing
