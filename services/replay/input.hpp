// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <functional>
#include <thread>

#include "common/concurrency/bounded_queue.hpp"
#include "services/replay/core/player.hpp"

namespace rtd::replay {

/// Events for the player from keyboard, bus and signals. Any thread posts, one takes.
using Inbox = concurrency::BoundedQueue<Event>;

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
