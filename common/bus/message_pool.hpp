// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace rtd::bus {

/// Lends uninitialised messages as shared pointers and takes their memory back: a fresh frame would cost 375 page
/// faults. Messages may outlive the pool. Thread-safe.
template <class T>
class MessagePool {
 public:
  std::shared_ptr<T> acquire() const {
    return std::shared_ptr<T>(spares_->pop().release(),
                              [spares = spares_](T* message) { spares->push(std::unique_ptr<T>(message)); });
  }

 private:
  static constexpr std::size_t kMaxSpares = 8;

  class Spares {
   public:
    std::unique_ptr<T> pop() {
      const std::lock_guard lock(mutex_);
      if (messages_.empty()) return std::unique_ptr<T>(new T);  // not value-initialised: it is overwritten at once
      std::unique_ptr<T> message = std::move(messages_.back());
      messages_.pop_back();
      return message;
    }
    void push(std::unique_ptr<T> message) {
      const std::lock_guard lock(mutex_);
      if (messages_.size() < kMaxSpares) messages_.push_back(std::move(message));
    }

   private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<T>> messages_;
  };

  std::shared_ptr<Spares> spares_ = std::make_shared<Spares>();
};

}  // namespace rtd::bus
