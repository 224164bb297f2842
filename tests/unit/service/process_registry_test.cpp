// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/peer_table.hpp"

#include <gtest/gtest.h>

#include "common/service/peer_clocks.hpp"

namespace rtd::service {
namespace {

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

}  // namespace
}  // namespace rtd::service
