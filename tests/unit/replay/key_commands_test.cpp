// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/player.hpp"

#include <gmock/gmock.h>

namespace rtd::replay {
namespace {

std::vector<Command> typed(const std::string& bytes) {
  KeyCommands keys;
  std::vector<Command> commands;
  for (const char byte : bytes)
    if (const auto command = keys.next(byte)) commands.push_back(*command);
  return commands;
}

TEST(KeyCommands, knows_the_keys_of_rosbag2) {
  EXPECT_THAT(typed(" \x1b[C\x1b[A\x1b[B"),
              testing::ElementsAre(Command::kTogglePause, Command::kStep, Command::kFaster, Command::kSlower));
  EXPECT_THAT(typed("sbfq"), testing::ElementsAre(Command::kStep, Command::kBack, Command::kForward, Command::kStop));
}

TEST(KeyCommands, takes_no_part_of_another_sequence_for_a_key) {
  EXPECT_THAT(typed("\x1b[5~"), testing::IsEmpty()) << "page up";
  EXPECT_THAT(typed("\x1b[1;5C"), testing::ElementsAre(Command::kStep)) << "with control";
  EXPECT_THAT(typed("\x1bOC"), testing::ElementsAre(Command::kStep)) << "application mode";
  EXPECT_THAT(typed("\x1b\x1b[A"), testing::ElementsAre(Command::kFaster));
  EXPECT_THAT(typed("xyz\x7f"), testing::IsEmpty());
}

}  // namespace
}  // namespace rtd::replay
