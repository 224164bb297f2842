// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rtd::msg {

/// "a, b or c", for help texts and messages that name every entry of a table; `last` comes before the last word.
inline std::string word_list(const std::vector<std::string>& words, const std::string& last = " or ") {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
  }
  return text;
}

}  // namespace rtd::msg
