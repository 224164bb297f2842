// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/inbox.hpp"

#include <chrono>

namespace rtd::replay {

void Inbox::post(Event event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
  }
  posted_.notify_one();
}

std::optional<Event> Inbox::take_until(std::int64_t deadline_ns) {
  const std::chrono::steady_clock::time_point deadline{std::chrono::nanoseconds(deadline_ns)};
  std::unique_lock lock(mutex_);
  posted_.wait_until(lock, deadline, [this] { return !events_.empty(); });
  if (events_.empty()) return std::nullopt;
  const Event event = events_.front();
  events_.pop_front();
  return event;
}

}  // namespace rtd::replay
