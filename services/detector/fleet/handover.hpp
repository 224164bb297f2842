// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace rtd::detector {

/// One place between two threads. The first one can wait until the second one wants something, so that it does not
/// prepare what will be old when it is used. Thread-safe.
template <class T>
class Handover {
 public:
  using Clock = std::chrono::steady_clock;

  /// Waits until the place is free; the time at which it became free. Empty once closed.
  std::optional<Clock::time_point> wait_free() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !item_; });
    return closed_ ? std::nullopt : std::optional(taken_at_);
  }
  /// Waits until the taker waits for the next item, or until the time.
  void wait_wanted(Clock::time_point latest) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, latest, [this] { return closed_ || wanted_; });
  }
  /// The place must be free.
  void put(T item) {
    {
      const std::lock_guard lock(mutex_);
      item_ = std::move(item);
    }
    changed_.notify_all();
  }
  /// Empty when nothing came in time, or once closed.
  std::optional<T> take_for(std::chrono::milliseconds timeout) {
    std::unique_lock lock(mutex_);
    wanted_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, timeout, [this] { return closed_ || item_; });
    wanted_ = false;
    if (item_) taken_at_ = Clock::now();
    std::optional<T> taken = std::exchange(item_, std::nullopt);
    lock.unlock();
    changed_.notify_all();
    return taken;
  }
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> item_;
  Clock::time_point taken_at_{};
  bool wanted_ = false, closed_ = false;
};

}  // namespace rtd::detector
