// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <string>

namespace rtd::service {

/// Says how far long work is: one line with a bar that is rewritten on a terminal, a line every ten seconds elsewhere;
/// nothing for work that ends within a second.
class Progress {
 public:
  /// `total` in any unit: files, bytes, ...
  Progress(std::ostream& err, std::string work, std::uint64_t total);
  ~Progress();  ///< clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// One more is done.
  void advance() { reach(done_ + 1); }
  /// So many are done.
  void reach(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::ostream& err_;
  std::string work_;
  std::uint64_t total_, done_ = 0;
  bool interactive_, shown_ = false;
  Clock::time_point started_ = Clock::now(), next_ = started_ + std::chrono::seconds(1);
};

/// "reading  [######..............]  30 %, 12 s left"
std::string progress_line(const std::string& work, std::uint64_t done, std::uint64_t total, double elapsed_s);

}  // namespace rtd::service
