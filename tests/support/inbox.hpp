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

/// Keeps what a reader was given; tests wait for it. Copies are the same inbox: a reader with one of its own may
/// outlive the test's. Thread-safe.
template <class T>
class Inbox {
 public:
  void take(std::shared_ptr<const T> message) const {
    {
      const std::lock_guard lock(content_->mutex);
      content_->messages.push_back(std::move(message));
    }
    content_->arrived.notify_all();
  }
  /// True once `ready(messages)` holds, false when it never did within the time.
  template <class Predicate>
  bool wait(Predicate ready, std::chrono::milliseconds patience = std::chrono::seconds(20)) const {
    std::unique_lock lock(content_->mutex);
    return content_->arrived.wait_for(lock, patience, [&] { return ready(content_->messages); });
  }
  bool wait_count(std::size_t count, std::chrono::milliseconds patience = std::chrono::seconds(20)) const {
    return wait([count](const auto& messages) { return messages.size() >= count; }, patience);
  }
  std::shared_ptr<const T> at(std::size_t index) const {
    const std::lock_guard lock(content_->mutex);
    return content_->messages.at(index);
  }
  std::vector<std::shared_ptr<const T>> all() const {
    const std::lock_guard lock(content_->mutex);
    return content_->messages;
  }

 private:
  struct Content {
    std::mutex mutex;
    std::condition_variable arrived;
    std::vector<std::shared_ptr<const T>> messages;
  };
  std::shared_ptr<Content> content_ = std::make_shared<Content>();
};

}  // namespace rtd::test_support
