// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/message_queue.hpp"

#include <utility>

namespace rtd::recorder {

bool MessageQueue::push(QueuedMessage message) {
  const std::uint64_t size = message.bytes->view().size();
  const std::uint64_t room = size < kLargeMessage ? max_bytes_ : max_bytes_ - max_bytes_ / 8;
  bool enough = false;
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || bytes_ + size > room) return false;
    enough = bytes_ < kEnoughToWrite && bytes_ + size >= kEnoughToWrite;
    bytes_ += size;
    messages_.push_back(std::move(message));
  }
  if (enough) ready_.notify_one();
  return true;
}

void MessageQueue::wait_for(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  ready_.wait_for(lock, timeout, [this] { return closed_ || bytes_ >= kEnoughToWrite; });
}

std::optional<QueuedMessage> MessageQueue::pop() {
  const std::lock_guard lock(mutex_);
  if (messages_.empty()) return std::nullopt;
  std::optional<QueuedMessage> message(std::move(messages_.front()));
  messages_.pop_front();
  bytes_ -= message->bytes->view().size();
  return message;
}

void MessageQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  ready_.notify_all();
}

std::uint64_t MessageQueue::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace rtd::recorder
