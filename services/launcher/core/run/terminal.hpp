// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <ostream>
#include <string>
#include <utility>

namespace rtd::launcher {

struct LiveStatus;

/// "frame 123/210  29.8 fps  ok  inliers 213  dynamic 87  dropped 0  latency 31 ms  3 s left", the last part for
/// sources of known length.
std::string format_live_status(const LiveStatus& status);

/// Output of a run: messages, and one status line that is updated in place on a terminal and repeated every two seconds
/// elsewhere. Lines that the stream has no room for are left out and counted: a run must not stand still because no one
/// reads what it prints. Time comes in as an argument. Not thread-safe.
class Terminal {
 public:
  struct Options {
    bool interactive = false;  ///< the stream is a terminal
    bool quiet = false;        ///< only warnings
    std::size_t columns = 100;
    std::function<bool()> has_room = {};  ///< whether the stream takes a line without a wait; empty: always
    bool color = false;                   ///< warnings in yellow
  };

  Terminal(std::ostream& out, Options options) : out_(out), options_(std::move(options)) {}

  void print(const std::string& line);  ///< not shown when quiet
  void warn(const std::string& line);   ///< always shown
  void status(const std::string& line, std::chrono::milliseconds now);
  /// Ends the status line, so that what follows starts on a fresh one.
  void end_status();

 private:
  void write(const std::string& line, bool colored);
  bool takes_line();
  void clear_status();

  std::ostream& out_;
  Options options_;
  std::string shown_;
  int left_out_ = 0;  ///< messages since the last one that was shown
  std::chrono::milliseconds next_{};
};

}  // namespace rtd::launcher
