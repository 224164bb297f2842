// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "common/service/peer_health.hpp"

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
  watch.forgive(60'000 * kNsPerMs);
  EXPECT_EQ(watch.stuck_ns(100'000 * kNsPerMs), 0) << "it has not begun";
  watch.tick(1000 * kNsPerMs);
  watch.forgive(10'000 * kNsPerMs);
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

/// Looks ten times a second.
class InputWatchTest : public testing::Test {
 protected:
  /// Whether it received nothing at the last look; each look finds so many more sent and received.
  bool look(int times, int sent, int received) {
    bool receives_nothing = false;
    for (int i = 0; i < times; ++i) {
      for (int j = 0; j < received; ++j) watch_.received();
      receives_nothing = watch_.receives_nothing(now_ns_ += 100 * kNsPerMs, sent_ += sent);
    }
    return receives_nothing;
  }
  InputWatch watch_;
  std::int64_t now_ns_ = 0;
  double sent_ = 0;
};

TEST_F(InputWatchTest, one_that_received_before_and_receives_nothing_more_is_cut_off) {
  EXPECT_FALSE(look(10, 3, 3));
  EXPECT_FALSE(look(15, 3, 0));
  EXPECT_TRUE(look(1, 3, 0));
  EXPECT_FALSE(look(1, 3, 1)) << "it receives again";
}

TEST_F(InputWatchTest, silence_of_the_sender_does_not_count) {
  look(10, 3, 3);
  EXPECT_FALSE(look(50, 0, 0));
  EXPECT_FALSE(watch_.receives_nothing(now_ns_ += 100 * kNsPerMs, std::nullopt)) << "the sender is gone";
  sent_ = 0;
  EXPECT_FALSE(look(10, 3, 0)) << "another one begins to count";
  EXPECT_TRUE(look(10, 3, 0));
}

TEST_F(InputWatchTest, one_that_never_received_may_not_be_meant) {
  EXPECT_FALSE(look(50, 3, 0));
}

TEST_F(InputWatchTest, one_that_was_stopped_has_time_to_take_what_waits) {
  look(10, 3, 3);
  now_ns_ += 3000 * kNsPerMs;
  EXPECT_FALSE(look(1, 90, 0));
  EXPECT_FALSE(look(1, 3, 90));
}

}  // namespace
}  // namespace rtd::service
