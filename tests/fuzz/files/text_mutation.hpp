// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/bytes.hpp"
#include "tests/fuzz/mcap/mutation.hpp"

namespace rtd::testing {

inline io::Bytes bytes_of(std::string_view text) {
  const auto view = io::bytes_of(text);
  return {view.begin(), view.end()};
}

inline std::string text_of(const io::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Changes bytes, or puts words of a language into its texts: between lines, into them, or in place of something.
inline io::Bytes mutate_text(const std::vector<std::string>& texts, const std::vector<std::string>& words,
                             std::mt19937_64& random) {
  const std::string& seed = texts[random() % texts.size()];
  if (random() % 3 == 0) return mcap::mutate(bytes_of(seed), bytes_of(texts[random() % texts.size()]), random);
  std::string text = seed;
  for (std::uint64_t changes = 1 + random() % 4; changes > 0; --changes) {
    std::string word = words[random() % words.size()];
    if (random() % 40 == 0) {
      const std::string one = word;
      for (std::uint64_t more = random() % 3000; more > 0; --more) word += one;
    }
    std::size_t at = random() % (text.size() + 1);
    if (random() % 2 == 0) at = std::min(text.find('\n', at), text.size());
    text.replace(at, random() % 3 == 0 ? random() % 12 : 0, word);
  }
  return bytes_of(text);
}

}  // namespace rtd::testing
