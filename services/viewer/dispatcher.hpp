// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

namespace rtd::viewer {

/// Hands work from the bus's threads to the viewer's, bounded in number and bytes: if that one falls behind, messages
/// are dropped and counted, changes of topics are not. Thread-safe; copies share one count.
class Dispatcher {
 public:
  using Task = std::function<void()>;
  explicit Dispatcher(std::function<void(Task)> post) : post_(std::move(post)) {}

  /// A message, which may be dropped. `bytes`: of memory that the task keeps until it has run.
  void deliver(Task task, std::size_t bytes) const {
    const bool full = state_->waiting.fetch_add(1) >= kMaxWaiting;
    const std::size_t before = state_->bytes.fetch_add(bytes);
    if (full || (before > 0 && before + bytes > kMaxBytes)) {  // a large one alone may pass
      state_->take(bytes);
      ++state_->dropped;
      return;
    }
    post_([state = state_, bytes, task = std::move(task)] {
      state->take(bytes);
      task();
    });
  }
  /// Something that must happen.
  void order(Task task) const { post_(std::move(task)); }
  std::uint64_t dropped() const { return state_->dropped; }

 private:
  static constexpr int kMaxWaiting = 512;
  static constexpr std::size_t kMaxBytes = std::size_t{32} << 20;
  struct State {
    void take(std::size_t taken) {
      --waiting;
      bytes -= taken;
    }
    std::atomic<int> waiting{0};
    std::atomic<std::size_t> bytes{0};
    std::atomic<std::uint64_t> dropped{0};
  };
  std::function<void(Task)> post_;
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace rtd::viewer
