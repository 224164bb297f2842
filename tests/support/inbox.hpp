// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace rtd::test_support {

/// Keeps what a reader was given; tests wait for it. Thread-safe.
template <class T>
class Inbox {
 public:
  void take(std::shared_ptr<const T> message) {
    {
      const std::lock_guard lock(mutex_);
      messages_.push_back(std::move(message));
    }
    arrived_.notify_all();
  }
  /// True once `ready(messages)` holds, false when it never did within the time.
  template <class Predicate>
  bool wait(Predicate ready, std::chrono::milliseconds patience = std::chrono::seconds(20)) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, patience, [&] { return ready(messages_); });
  }
  bool wait_count(std::size_t count, std::chrono::milliseconds patience = std::chrono::seconds(20)) {
    return wait([count](const auto& messages) { return messages.size() >= count; }, patience);
  }
  std::shared_ptr<const T> at(std::size_t index) const {
    const std::lock_guard lock(mutex_);
    return messages_.at(index);
  }
  std::vector<std::shared_ptr<const T>> all() const {
    const std::lock_guard lock(mutex_);
    return messages_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<std::shared_ptr<const T>> messages_;
};

}  // namespace rtd::test_support
