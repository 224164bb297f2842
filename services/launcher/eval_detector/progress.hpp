// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>

namespace rtd::launcher {

/// Says how far long work is: one line that is rewritten on a terminal, a line every ten seconds elsewhere; nothing
/// for work that ends within a second.
class Progress {
 public:
  Progress(std::ostream& err, std::string work, std::size_t total);
  ~Progress();  ///< clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// One more is done.
  void advance();

 private:
  using Clock = std::chrono::steady_clock;
  std::ostream& err_;
  std::string work_;
  std::size_t total_, done_ = 0;
  bool interactive_, shown_ = false;
  Clock::time_point started_ = Clock::now(), next_ = started_ + std::chrono::seconds(1);
};

}  // namespace rtd::launcher
