// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/callback_thread.hpp"

#include <utility>

namespace rtd::bus {

CallbackThread::CallbackThread(std::function<bool()> handle_one)
    : handle_one_(std::move(handle_one)), thread_([this] { loop(); }) {}

void CallbackThread::post(std::function<void()> event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
  }
  changed_.notify_one();
}

void CallbackThread::wake() {
  {
    const std::lock_guard lock(mutex_);
    messages_waiting_ = true;
  }
  changed_.notify_one();
}

void CallbackThread::stop() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void CallbackThread::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ended_ || !events_.empty() || messages_waiting_; });
    if (ended_) return;
    if (!events_.empty()) {
      const auto event = std::move(events_.front());
      events_.pop_front();
      lock.unlock();
      event();
      lock.lock();
    } else {
      messages_waiting_ = false;
      lock.unlock();
      const bool handled = handle_one_();
      lock.lock();
      messages_waiting_ |= handled;  // the next may wait already
    }
  }
}

StatusReporter::StatusReporter(StatusCallbacks callbacks) : callbacks_(std::move(callbacks)) {
  if (callbacks_.on_matched || callbacks_.on_incompatible_qos || callbacks_.on_deadline_missed ||
      callbacks_.on_type_mismatch || callbacks_.on_too_large)
    thread_ = &own_.emplace();
}

void StatusReporter::report_matched(int peers) {
  matched_ = peers;
  post(callbacks_.on_matched, peers);
}

}  // namespace rtd::bus
