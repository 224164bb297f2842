// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace rtd::launcher {

/// Output of a run: messages, and one status line that is updated in place on a terminal and repeated every two seconds
/// elsewhere. Time comes in as an argument. Not thread-safe.
class Terminal {
 public:
  struct Options {
    bool interactive = false;  ///< the stream is a terminal
    bool quiet = false;        ///< only warnings
    std::size_t columns = 100;
  };

  Terminal(std::ostream& out, Options options) : out_(out), options_(options) {}

  void print(const std::string& line);  ///< not shown when quiet
  void warn(const std::string& line);   ///< always shown
  void status(const std::string& line, std::chrono::milliseconds now);
  /// Ends the status line, so that what follows starts on a fresh one.
  void end_status();

 private:
  void clear_status();
  std::ostream& out_;
  Options options_;
  std::string shown_;
  std::chrono::milliseconds next_{};
};

}  // namespace rtd::launcher
