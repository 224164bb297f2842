// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "common/bus/raw_bus.hpp"

namespace rtd::recorder {

struct QueuedMessage {
  std::size_t topic = 0;  ///< index in the TopicRegistry
  std::uint32_t sequence = 0;
  std::uint64_t received_ns = 0, source_ns = 0;
  std::shared_ptr<const bus::ByteBlock> bytes;
};

/// The messages that wait for the disk, bounded in bytes. When it is full, the newest message is refused. Large
/// messages are refused somewhat earlier, so that images do not displace poses. Thread-safe.
class MessageQueue {
 public:
  explicit MessageQueue(std::uint64_t max_bytes) : max_bytes_(max_bytes) {}

  /// False: no room (or closed).
  bool push(QueuedMessage message);
  /// Waits until there is enough to write, the time is over or the queue is closed. Waking the writer for each message
  /// would cost more than writing it.
  void wait_for(std::chrono::milliseconds timeout);
  /// The oldest message; empty when there is none. Does not wait.
  std::optional<QueuedMessage> pop();
  void close();
  std::uint64_t bytes() const;

 private:
  static constexpr std::uint64_t kLargeMessage = 64 * 1024;
  static constexpr std::uint64_t kEnoughToWrite = 1024 * 1024;

  const std::uint64_t max_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable ready_;
  std::deque<QueuedMessage> messages_;
  std::uint64_t bytes_ = 0;
  bool closed_ = false;
};

}  // namespace rtd::recorder
