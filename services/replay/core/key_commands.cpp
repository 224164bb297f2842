// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/key_commands.hpp"

namespace rtd::replay {
namespace {

std::optional<Command> of_arrow(char last) {
  switch (last) {
    case 'A':
      return Command::kFaster;
    case 'B':
      return Command::kSlower;
    case 'C':
      return Command::kStep;
    default:
      return std::nullopt;
  }
}

std::optional<Command> of_letter(char byte) {
  switch (byte) {
    case ' ':
      return Command::kTogglePause;
    case 's':
      return Command::kStep;
    case 'b':
      return Command::kBack;
    case 'f':
      return Command::kForward;
    case 'q':
      return Command::kStop;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<Command> KeyCommands::next(char byte) {
  constexpr char kEscape = '\x1b';
  if (byte == kEscape) {
    pending_ = byte;
    return std::nullopt;
  }
  if (pending_.empty()) return of_letter(byte);
  const bool introduced = pending_.size() > 1;
  if (!introduced && (byte == '[' || byte == 'O')) {
    pending_ += byte;
    return std::nullopt;
  }
  const bool ends = !introduced || (byte >= '@' && byte <= '~');  // parameters such as "1;5" come before
  if (!ends) return std::nullopt;
  pending_.clear();
  return introduced ? of_arrow(byte) : of_letter(byte);
}

}  // namespace rtd::replay
