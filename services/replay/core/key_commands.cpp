// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/key_commands.hpp"

#include <map>

namespace rtd::replay {
namespace {

using Keys = std::map<char, Command>;

std::optional<Command> find(const Keys& keys, char byte) {
  const auto key = keys.find(byte);
  return key == keys.end() ? std::nullopt : std::optional(key->second);
}

}  // namespace

std::optional<Command> KeyCommands::next(char byte) {
  static const Keys kArrows = {{'A', Command::kFaster}, {'B', Command::kSlower}, {'C', Command::kStep}};
  static const Keys kLetters = {{' ', Command::kTogglePause},
                                {'s', Command::kStep},
                                {'b', Command::kBack},
                                {'f', Command::kForward},
                                {'q', Command::kStop}};
  constexpr char kEscape = '\x1b';
  if (byte == kEscape) {
    pending_ = byte;
    return std::nullopt;
  }
  if (pending_.empty()) return find(kLetters, byte);
  const bool introduced = pending_.size() > 1;
  if (!introduced && (byte == '[' || byte == 'O')) {
    pending_ += byte;
    return std::nullopt;
  }
  const bool ends = !introduced || (byte >= '@' && byte <= '~');  // parameters such as "1;5" come before
  if (!ends) return std::nullopt;
  pending_.clear();
  return find(introduced ? kArrows : kLetters, byte);
}

}  // namespace rtd::replay
