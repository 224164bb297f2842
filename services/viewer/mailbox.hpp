// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

namespace rtd::viewer {

/// Hands work from the bus's threads to the viewer's, bounded: if that one falls behind, messages are dropped and
/// counted, changes of topics are not. Thread-safe; copies share one count.
class Mailbox {
 public:
  using Task = std::function<void()>;
  explicit Mailbox(std::function<void(Task)> post) : post_(std::move(post)) {}

  /// A message, which may be dropped.
  void deliver(Task task) const {
    if (state_->waiting.fetch_add(1) >= kMostWaiting) {
      --state_->waiting;
      ++state_->dropped;
      return;
    }
    post_([state = state_, task = std::move(task)] {
      --state->waiting;
      task();
    });
  }
  /// Something that must happen.
  void order(Task task) const { post_(std::move(task)); }
  std::uint64_t dropped() const { return state_->dropped; }

 private:
  static constexpr int kMostWaiting = 512;
  struct State {
    std::atomic<int> waiting{0};
    std::atomic<std::uint64_t> dropped{0};
  };
  std::function<void(Task)> post_;
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace rtd::viewer
