// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace rtd::bus {

/// What the library of a vendor logs, on stderr: printable lines of at most 240 characters, and at most ten in ten
/// seconds, because any peer can cause one with each packet. Thread-safe.
class LibraryLog {
 public:
  explicit LibraryLog(std::string library) : library_(std::move(library)) {}
  void print(std::string_view text);

 private:
  const std::string library_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point begin_;
  int lines_ = 0;
};

/// A line as it is shown: without line ends, not too long.
std::string shown_line(std::string_view text);

}  // namespace rtd::bus
