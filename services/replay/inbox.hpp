// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "services/replay/core/player.hpp"

namespace rtd::replay {

/// What keyboard, bus and signals have to say to the player. Any thread posts, one takes.
class Inbox {
 public:
  void post(Event event);
  /// The next event; waits for one until the deadline (CLOCK_MONOTONIC).
  std::optional<Event> take_until(std::int64_t deadline_ns);

 private:
  std::mutex mutex_;
  std::condition_variable posted_;
  std::deque<Event> events_;
};

}  // namespace rtd::replay
