// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/inprocess/dispatcher.hpp"

#include <utility>

namespace rtd::bus::inprocess {

Dispatcher::Dispatcher(std::size_t depth, std::function<void(Message)> on_message)
    : depth_(depth), on_message_(std::move(on_message)), thread_([this] { loop(); }) {}

Dispatcher::~Dispatcher() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool Dispatcher::deliver(Message message) {
  bool kept_all = true;
  {
    const std::lock_guard lock(mutex_);
    if (messages_.size() >= depth_) {
      messages_.pop_front();
      kept_all = false;
    }
    messages_.push_back(std::move(message));
  }
  wake_.notify_one();
  return kept_all;
}

void Dispatcher::notify(std::function<void()> event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
  }
  wake_.notify_one();
}

void Dispatcher::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return ended_ || !events_.empty() || !messages_.empty(); });
    if (ended_) return;
    if (!events_.empty()) {
      const auto event = std::move(events_.front());
      events_.pop_front();
      lock.unlock();
      event();
    } else {
      Message message = std::move(messages_.front());
      messages_.pop_front();
      lock.unlock();
      on_message_(std::move(message));
    }
    lock.lock();
  }
}

}  // namespace rtd::bus::inprocess
