// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "common/bus/callback_thread.hpp"

namespace rtd::bus::inprocess {

using Message = std::shared_ptr<const void>;

/// What waits for one reader: at most `depth` messages; one more pushes the oldest out, as a keep-last history does.
/// Thread-safe.
class Mailbox {
 public:
  Mailbox(std::size_t depth, std::function<void(Message)> on_message)
      : depth_(depth), on_message_(std::move(on_message)), thread_([this] { return handle_one(); }) {}

  /// Never blocks. False when an older message had to go.
  bool deliver(Message message);
  CallbackThread& thread() { return thread_; }

 private:
  bool handle_one();
  std::optional<Message> pop();

  const std::size_t depth_;
  const std::function<void(Message)> on_message_;
  std::mutex mutex_;
  std::deque<Message> messages_;
  CallbackThread thread_;
};

}  // namespace rtd::bus::inprocess
