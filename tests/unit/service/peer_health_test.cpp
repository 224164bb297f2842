// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "common/service/peer_table.hpp"

namespace rtd::service {
namespace {

constexpr std::int64_t kNsPerMs = 1'000'000;

TEST(PeerHealth, a_gone_process_is_dead_before_the_others_wait_half_a_second) {
  EXPECT_EQ(judge({250 * kNsPerMs, ProcessState::kGone}), PeerHealth::kAlive) << "its last heartbeat is recent";
  EXPECT_EQ(judge({350 * kNsPerMs, ProcessState::kGone}), PeerHealth::kDead);
}

TEST(PeerHealth, a_silent_process_that_is_there_is_hung_within_two_seconds) {
  EXPECT_EQ(judge({900 * kNsPerMs, ProcessState::kRunning}), PeerHealth::kAlive) << "may wait for the processor";
  EXPECT_EQ(judge({1500 * kNsPerMs, ProcessState::kRunning}), PeerHealth::kHung);
}

TEST(PeerHealth, silence_from_another_host_is_death) {
  EXPECT_EQ(judge({900 * kNsPerMs, ProcessState::kUnknown}), PeerHealth::kAlive);
  EXPECT_EQ(judge({1500 * kNsPerMs, ProcessState::kUnknown}), PeerHealth::kDead);
}

TEST(PeerHealth, what_waits_for_a_slow_peer_waits_for_ten_seconds_but_not_for_a_gone_one) {
  EXPECT_FALSE(surely_gone({9'000 * kNsPerMs, ProcessState::kRunning}));
  EXPECT_FALSE(surely_gone({9'000 * kNsPerMs, ProcessState::kUnknown}));
  EXPECT_TRUE(surely_gone({10'000 * kNsPerMs, ProcessState::kRunning}));
  EXPECT_TRUE(surely_gone({350 * kNsPerMs, ProcessState::kGone}));
}

TEST(PeerHealth, the_state_of_a_process_is_read) {
  EXPECT_EQ(process_state(getpid()), ProcessState::kRunning);
  const pid_t child = fork();
  if (child == 0) {
    while (true) pause();
  }
  kill(child, SIGSTOP);
  waitpid(child, nullptr, WUNTRACED);
  EXPECT_EQ(process_state(child), ProcessState::kRunning) << "stopped, but there";
  kill(child, SIGKILL);
  siginfo_t ended{};
  waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
  EXPECT_EQ(process_state(child), ProcessState::kGone) << "a zombie";
  waitpid(child, nullptr, 0);
  EXPECT_EQ(process_state(child), ProcessState::kGone);
}

TEST(ProgressWatch, only_a_worker_that_has_begun_and_does_not_wait_gets_stuck) {
  ProgressWatch watch;
  watch.tick(1);
  EXPECT_EQ(watch.stuck_ns(9'000 * kNsPerMs), 0) << "no limit";
  watch.set_limit(1500 * kNsPerMs);
  watch.tick(1000 * kNsPerMs);
  EXPECT_EQ(watch.stuck_ns(2000 * kNsPerMs), 0);
  EXPECT_EQ(watch.stuck_ns(2600 * kNsPerMs), 1600 * kNsPerMs);
  watch.idle();
  EXPECT_EQ(watch.stuck_ns(9000 * kNsPerMs), 0);
}

TEST(ProgressWatch, a_worker_is_not_stuck_for_the_time_in_which_its_process_stood_still) {
  ProgressWatch watch;
  watch.set_limit(1500 * kNsPerMs);
  watch.exclude_pause(60'000 * kNsPerMs);
  EXPECT_EQ(watch.stuck_ns(100'000 * kNsPerMs), 0) << "it has not begun";
  watch.tick(1000 * kNsPerMs);
  watch.exclude_pause(10'000 * kNsPerMs);
  EXPECT_EQ(watch.stuck_ns(12'000 * kNsPerMs), 0);
  EXPECT_EQ(watch.stuck_ns(13'000 * kNsPerMs), 2000 * kNsPerMs);
}

TEST(StandstillWatch, distinguishes_a_stop_of_the_process_from_its_work) {
  StandstillWatch watch;
  EXPECT_EQ(watch.look(5000 * kNsPerMs), 0) << "the first look";
  EXPECT_EQ(watch.look(5400 * kNsPerMs), 0) << "a busy host";
  EXPECT_EQ(watch.look(15'400 * kNsPerMs), 10'000 * kNsPerMs);
  EXPECT_EQ(watch.look(15'500 * kNsPerMs), 0);
}

}  // namespace
}  // namespace rtd::service
