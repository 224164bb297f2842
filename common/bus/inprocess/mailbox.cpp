// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/inprocess/mailbox.hpp"

#include <utility>

namespace rtd::bus::inprocess {

bool Mailbox::deliver(Message message) {
  bool kept_all = true;
  {
    const std::lock_guard lock(mutex_);
    if (messages_.size() >= depth_) {
      messages_.pop_front();
      kept_all = false;
    }
    messages_.push_back(std::move(message));
  }
  thread_.wake();
  return kept_all;
}

bool Mailbox::handle_one() {
  std::optional<Message> message = pop();
  if (!message) return false;
  on_message_(std::move(*message));
  return true;
}

std::optional<Message> Mailbox::pop() {
  const std::lock_guard lock(mutex_);
  if (messages_.empty()) return std::nullopt;
  std::optional<Message> message(std::move(messages_.front()));
  messages_.pop_front();
  return message;
}

}  // namespace rtd::bus::inprocess
