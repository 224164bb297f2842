// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rtd::replay {

/// What a key press asks for.
enum class Command { kTogglePause, kStep, kFaster, kSlower, kBack, kForward, kStop };

/// Turns the bytes of a terminal into commands, also when an escape sequence arrives in pieces. Keys as in rosbag2:
/// space, right arrow (or s), up, down; also b and f (10 s back, forward) and q.
class KeyCommands {
 public:
  std::optional<Command> next(char byte);

 private:
  std::string pending_;  ///< an escape sequence so far
};

}  // namespace rtd::replay
