// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <functional>
#include <thread>

#include "services/replay/core/key_commands.hpp"

namespace rtd::replay {

/// Listens to the keys of the terminal, each as it is pressed. The terminal is as it was when this is destroyed.
/// Without a terminal, or in the background, there are no keys.
class Keyboard {
 public:
  explicit Keyboard(std::function<void(Command)> on_command);
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;
  bool listens() const { return listens_; }

 private:
  void listen();

  std::function<void(Command)> on_command_;
  termios before_{};
  int wake_fd_ = -1;
  bool listens_ = false;
  std::thread thread_;
};

}  // namespace rtd::replay
