// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/process/lost_lock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>

namespace rtd::launcher {
namespace {

void throw_in_a_thread(const char* what) {
  survive_lost_locks();
  std::thread([what] { throw std::runtime_error(what); }).detach();
}

/// Ends with 7 if one thread stands still.
void end_when_one_stands_still() {
  throw_in_a_thread("Interprocess mutex timeout when locking. Possible deadlock: owner died without unlocking?");
  for (int i = 0; i < 1000 && lost_locks() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::_Exit(lost_locks() == 1 ? 7 : 8);
}

void end_with_another_error() {
  throw_in_a_thread("disk full");
  std::this_thread::sleep_for(std::chrono::seconds(5));
  std::_Exit(8);
}

TEST(LostLockDeathTest, a_thread_whose_lock_is_lost_stands_still_and_the_process_continues) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(end_when_one_stands_still(), testing::ExitedWithCode(7), "");
}

TEST(LostLockDeathTest, any_other_error_still_ends_the_process) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(end_with_another_error(), testing::KilledBySignal(SIGABRT), "disk full");
}

}  // namespace
}  // namespace rtd::launcher
