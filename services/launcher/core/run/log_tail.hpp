// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::launcher {

/// Splits a byte stream into lines. A line longer than 4096 bytes comes in pieces.
class LineSplitter {
 public:
  /// Calls `on_line` for every line that `bytes` completes (without its newline).
  void feed(std::string_view bytes, const std::function<void(const std::string&)>& on_line);
  /// Passes on the rest that has no newline.
  void finish(const std::function<void(const std::string&)>& on_line);

 private:
  std::string rest_;
};

/// The last lines of a log.
class LogTail {
 public:
  explicit LogTail(std::size_t max_lines = 12) : max_lines_(max_lines) {}
  void add(const std::string& line);
  std::vector<std::string> lines() const { return {lines_.begin(), lines_.end()}; }

 private:
  std::size_t max_lines_;
  std::deque<std::string> lines_;
};

enum class LogLevel { kInfo, kWarning, kError };

/// The level of a service's log line: "12:34:56.789 warning slam event=..." or "rtd-slam: why it cannot run".
LogLevel level_of(std::string_view line);

/// Why a service refused to start: its last error line, else its last lines.
std::vector<std::string> reason_lines(const std::vector<std::string>& tail);

}  // namespace rtd::launcher
