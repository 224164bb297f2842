// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "services/replay/core/player.hpp"

namespace rtd::replay {

/// Events for the player from keyboard, bus and signals. Any thread posts, one takes.
class Inbox {
 public:
  void post(Event event);
  /// The next event; waits for one until the deadline (CLOCK_MONOTONIC).
  std::optional<Event> take_until(std::int64_t deadline_ns);
  /// Drops the events that wait and all that come.
  void close();

 private:
  std::mutex mutex_;
  std::condition_variable posted_;
  std::deque<Event> events_;
  bool closed_ = false;
};

/// Reads the keys of the terminal as they are pressed. The destructor restores the terminal. Without a terminal, or in
/// the background, there are no keys.
class Keyboard {
 public:
  explicit Keyboard(std::function<void(Command)> on_command);
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

 private:
  void listen();

  std::function<void(Command)> on_command_;
  termios before_{};
  int wake_fd_ = -1;
  std::thread thread_;
};

}  // namespace rtd::replay
