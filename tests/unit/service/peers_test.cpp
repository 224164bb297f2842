// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <set>

#include "common/service/peer_clocks.hpp"
#include "common/service/peer_table.hpp"

namespace rtd::service {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class ProcessBookTest : public testing::Test {
 protected:
  static constexpr std::int64_t kMs = 1'000'000;
  static bus::WriterId writer(int number) {
    bus::WriterId id{};
    id[0] = static_cast<std::uint8_t>(number);
    id[1] = static_cast<std::uint8_t>(number >> 8);
    return id;
  }
  void beat(int from, std::int64_t pid, bool here = true, msg::ServiceState state = msg::ServiceState::kRunning) {
    msg::ServiceStatus status{.service = "camera", .pid = pid, .state = state};
    status.metrics = {{"host_id", PeerClocks::this_host_id() + (here ? 0 : 1)}};
    book_.note(status, writer(from));
  }
  bool gone(int connection) const { return book_.gone(bus::participant_of(writer(connection))); }
  std::int64_t now_ns_ = 5000 * kMs, dead_pid_ = 0;
  ProcessRegistry book_{
      [this](std::int64_t pid) { return pid == dead_pid_ ? ProcessState::kGone : ProcessState::kRunning; },
      [this] { return now_ns_; }};
};

TEST_F(ProcessBookTest, a_silent_connection_whose_process_is_no_more_is_gone) {
  beat(1, 41);
  dead_pid_ = 41;
  EXPECT_FALSE(gone(1)) << "its message came just now: the number may be that of another container";
  now_ns_ += 350 * kMs;
  EXPECT_TRUE(gone(1));
}

TEST_F(ProcessBookTest, one_that_said_that_it_ends_is_gone) {
  beat(1, 41, false, msg::ServiceState::kFinished);
  EXPECT_TRUE(gone(1));
}

TEST_F(ProcessBookTest, a_connection_speaks_for_itself_only) {
  beat(1, 41);
  dead_pid_ = 666;
  beat(2, 666);
  beat(2, 41, true, msg::ServiceState::kFinished);
  now_ns_ += 5000 * kMs;
  EXPECT_FALSE(gone(1));
  EXPECT_TRUE(gone(2));
}

TEST_F(ProcessBookTest, of_other_hosts_and_unknown_ones_nothing_is_known) {
  beat(1, 41, false);
  dead_pid_ = 41;
  now_ns_ += 5000 * kMs;
  EXPECT_FALSE(gone(1));
  EXPECT_FALSE(gone(9));
}

TEST_F(ProcessBookTest, keeps_those_that_report_whatever_else_comes) {
  beat(1, 41);
  for (int i = 2; i < 1000; ++i) {
    now_ns_ += kMs;
    beat(i, 1000 + i);
    if (i % 20 == 0) beat(1, 41);
  }
  dead_pid_ = 41;
  now_ns_ += 350 * kMs;
  EXPECT_TRUE(gone(1));
}

class PeerTableTest : public testing::Test {
 protected:
  static constexpr std::int64_t kS = 1'000'000'000;
  static bus::WriterId writer(int number) {
    bus::WriterId id{};
    id[0] = static_cast<std::uint8_t>(number);
    id[1] = static_cast<std::uint8_t>(number >> 8);
    return id;
  }
  bool beat(const std::string& service, int from) { return table_.note({.service = service}, writer(from), now_ns_); }
  /// As many new names, each of a writer of its own.
  int make_up(int names) {
    int taken = 0;
    for (int i = 0; i < names; ++i, ++made_up_) taken += beat("x" + std::to_string(made_up_), 1000 + made_up_) ? 1 : 0;
    return taken;
  }
  std::int64_t now_ns_ = 100 * kS;
  int made_up_ = 0;
  std::set<bus::ParticipantId> gone_;
  PeerTable table_{[this](const bus::ParticipantId& connection) { return gone_.contains(connection); }};
};

TEST_F(PeerTableTest, made_up_names_take_no_place_from_a_service) {
  EXPECT_EQ(make_up(300), 100);
  EXPECT_TRUE(beat("slam", 1));
  EXPECT_TRUE(beat("camera", 2));
  EXPECT_FALSE(beat("one_more", 3)) << "the others are alive";
}

TEST_F(PeerTableTest, made_up_names_do_not_stay) {
  make_up(100);
  now_ns_ += 9 * kS;
  EXPECT_FALSE(beat("planner", 1));
  now_ns_ += 2 * kS;
  EXPECT_TRUE(beat("planner", 1)) << "a silent one makes room";
  EXPECT_THAT(table_.forget_silent(now_ns_), SizeIs(1));
  EXPECT_TRUE(beat("slam", 2));
  now_ns_ += 61 * kS;
  EXPECT_THAT(table_.forget_silent(now_ns_), SizeIs(100));
  EXPECT_THAT(table_.peers(), SizeIs(1)) << "slam is known for ever: it may be reported as dead";
}

TEST_F(PeerTableTest, one_writer_has_one_name) {
  EXPECT_TRUE(beat("mapper", 7));
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(beat("y" + std::to_string(i), 7));
  EXPECT_TRUE(beat("mapper", 7));
  EXPECT_THAT(table_.peers(), SizeIs(1));
  EXPECT_EQ(table_.refused(), 1000U);
}

TEST_F(PeerTableTest, a_name_belongs_to_the_one_that_lives) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += kS;
  EXPECT_FALSE(beat("slam", 2));
  EXPECT_TRUE(beat("slam", 1));
}

TEST_F(PeerTableTest, the_successor_of_one_that_died_has_its_name_at_once) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += kS / 2;
  gone_.insert(bus::participant_of(writer(1)));
  EXPECT_TRUE(beat("slam", 2));
  EXPECT_FALSE(beat("mapper", 2)) << "it has a name now";
}

TEST_F(PeerTableTest, one_that_was_silent_for_a_while_has_its_name_back) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += 2 * kS;
  EXPECT_TRUE(beat("slam", 2));
  EXPECT_TRUE(beat("slam", 1));
  EXPECT_FALSE(beat("slam", 2));
}

TEST_F(PeerTableTest, no_peer_was_silent_while_this_process_stood_still) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += 10 * kS;
  EXPECT_TRUE(beat("filter", 2));
  table_.exclude_pause(10 * kS, now_ns_);
  EXPECT_EQ(table_.peers().at("slam").received_ns, now_ns_);
  EXPECT_EQ(table_.peers().at("filter").received_ns, now_ns_) << "not in the future";
}

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
