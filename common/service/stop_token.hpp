// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <vector>

namespace rtd::service {

/// "Please end": set once by a signal, a fatal error or the end of the source. Thread-safe.
class StopToken {
 public:
  void request_stop();
  bool stop_requested() const;
  /// Sleeps until stop is requested or the time has passed; true when stop was requested.
  bool wait_for(std::chrono::nanoseconds duration) const;
  /// Runs `action` when stop is requested (at once when it already was). For closing queues.
  void on_stop(std::function<void()> action);

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::vector<std::function<void()>> actions_;
  bool stopped_ = false;
};

}  // namespace rtd::service
