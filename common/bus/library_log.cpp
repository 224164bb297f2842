// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/library_log.hpp"

#include <cstdio>

#include "common/io/printable.hpp"

namespace rtd::bus {

std::string shown_line(std::string_view text) {
  constexpr std::size_t kLongest = 240;
  text = text.substr(0, kLongest);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
  return io::printable(text);
}

void LibraryLog::print(std::string_view text) {
  using Clock = std::chrono::steady_clock;
  constexpr int kLinesAtOnce = 10;
  constexpr std::chrono::seconds kPeriod{10};
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (now - begin_ > kPeriod) {
    if (lines_ > kLinesAtOnce)
      std::fprintf(stderr, "%s: %d more lines like these\n", library_.c_str(), lines_ - kLinesAtOnce);
    begin_ = now;
    lines_ = 0;
  }
  if (++lines_ <= kLinesAtOnce) std::fprintf(stderr, "%s: %s\n", library_.c_str(), shown_line(text).c_str());
}

}  // namespace rtd::bus
