// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace rtd::bus {

/// Messages of a megabyte lie in huge pages where the kernel gives them: a frame then needs one entry of the page table
/// instead of 375, and is copied a quarter faster.
template <class T>
struct MessageMemory {
  static constexpr std::size_t kHugePage = 2U << 20U;
  static constexpr bool kHuge = std::is_trivially_destructible_v<T> && sizeof(T) >= kHugePage / 2;

  void operator()(T* message) const {
    if constexpr (kHuge) {
      std::free(message);
    } else {
      delete message;
    }
  }
  /// Not value-initialised: it is overwritten at once.
  static T* create() {
    if constexpr (kHuge) {
      const std::size_t bytes = (sizeof(T) + kHugePage - 1) / kHugePage * kHugePage;
      void* const memory = std::aligned_alloc(kHugePage, bytes);
      if (memory == nullptr) throw std::bad_alloc();
      madvise(memory, bytes, MADV_HUGEPAGE);  // refused: ordinary pages
      return new (memory) T;
    } else {
      return new T;
    }
  }
};

/// Lends uninitialised messages as shared pointers and takes their memory back: a fresh frame would cost 375 page
/// faults. What grew larger than any of our own is given back. Messages may outlive the pool. Thread-safe.
template <class T>
class MessagePool {
 public:
  std::shared_ptr<T> acquire() const {
    return std::shared_ptr<T>(spares_->pop().release(),
                              [spares = spares_](T* message) { spares->push(Owned(message)); });
  }

 private:
  using Owned = std::unique_ptr<T, MessageMemory<T>>;
  static constexpr std::size_t kMaxSpares = 8;
  static constexpr std::size_t kLargestSpare = 12U << 20U;  // bytes: a frame

  static bool is_worth_keeping(const T& message) {
    if constexpr (requires { message.capacity(); }) return message.capacity() <= kLargestSpare;
    return true;
  }

  class Spares {
   public:
    Owned pop() {
      const std::lock_guard lock(mutex_);
      if (messages_.empty()) return Owned(MessageMemory<T>::create());
      Owned message = std::move(messages_.back());
      messages_.pop_back();
      return message;
    }
    void push(Owned message) {
      const std::lock_guard lock(mutex_);
      if (messages_.size() < kMaxSpares && is_worth_keeping(*message)) messages_.push_back(std::move(message));
    }

   private:
    std::mutex mutex_;
    std::vector<Owned> messages_;
  };

  std::shared_ptr<Spares> spares_ = std::make_shared<Spares>();
};

}  // namespace rtd::bus
