// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/fleet/duty.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace rtd::detector {
namespace {

using Role = Duty::Role;

constexpr std::int64_t kDutyMs = 1'000'000;
const Claim kOwn{1000, 1, 10}, kOlder{900, 2, 20}, kYounger{1100, 3, 30};

/// Heartbeats every 200 ms until the time, beginning now.
void receive(Duty& duty, const Claim& other, std::int64_t from_ms, std::int64_t to_ms) {
  for (std::int64_t ms = from_ms; ms <= to_ms; ms += 200) {
    duty.observe(other, "box (pid 20)", true, ms * kDutyMs);
    duty.update(kOwn, ms * kDutyMs);
  }
}

TEST(Duty, serves_when_there_is_no_other) {
  Duty duty(0);
  EXPECT_EQ(duty.update(kOwn, Duty::kListenNs - 1), Role::kListening);
  EXPECT_EQ(duty.update(kOwn, Duty::kListenNs), Role::kServing);
  EXPECT_EQ(duty.other(), "");
}

TEST(Duty, a_newcomer_stands_by_even_when_its_clock_says_it_is_older) {
  Duty duty(0);
  receive(duty, kYounger, 500, 5000);
  EXPECT_EQ(duty.role(), Role::kStandby);
  EXPECT_EQ(duty.other(), "box (pid 20)");
}

TEST(Duty, takes_over_within_a_second_when_the_other_falls_silent) {
  Duty duty(0);
  receive(duty, kOlder, 200, 3000);
  EXPECT_EQ(duty.update(kOwn, 3700 * kDutyMs), Role::kStandby);
  EXPECT_EQ(duty.update(kOwn, 3800 * kDutyMs), Role::kServing);
  EXPECT_EQ(duty.other(), "");
}

TEST(Duty, takes_over_at_once_when_the_other_ends_or_hangs) {
  Duty duty(0);
  receive(duty, kOlder, 200, 3000);
  duty.observe(kOlder, "box (pid 20)", false, 3050 * kDutyMs);
  EXPECT_EQ(duty.update(kOwn, 3050 * kDutyMs), Role::kServing);
}

TEST(Duty, does_not_serve_before_it_has_waited) {
  Duty duty(0);
  duty.observe(kOlder, "box (pid 20)", false, 100 * kDutyMs);
  EXPECT_EQ(duty.update(kOwn, 100 * kDutyMs), Role::kListening);
}

TEST(Duty, of_two_that_serve_the_younger_steps_down) {
  Duty duty(0);
  duty.update(kOwn, 1000 * kDutyMs);
  receive(duty, kYounger, 2000, 4000);
  EXPECT_EQ(duty.role(), Role::kServing);
  receive(duty, kOlder, 5000, 5200);
  EXPECT_EQ(duty.role(), Role::kStandby);
}

TEST(Duty, one_heartbeat_ends_no_service) {
  Duty duty(0);
  duty.update(kOwn, 1000 * kDutyMs);
  duty.observe(kOlder, "box (pid 20)", true, 2000 * kDutyMs);
  EXPECT_EQ(duty.update(kOwn, 2000 * kDutyMs), Role::kServing);
}

TEST(Duty, claims_without_end_take_no_memory_without_end) {
  Duty duty(0);
  duty.update(kOwn, 1000 * kDutyMs);
  for (int i = 0; i < 100'000; ++i) duty.observe({i, 1, i}, "box", true, 1000 * kDutyMs);
  EXPECT_EQ(duty.update(kOwn, 1100 * kDutyMs), Role::kServing);
}

/// Three boxes that receive each other with a delay of 50 ms: exactly one serves soon after any of them dies.
TEST(Duty, several_boxes_agree_on_one) {
  std::vector<Duty> duties;
  std::vector<Claim> claims;
  for (int i = 0; i < 3; ++i) {
    duties.emplace_back(0);
    claims.push_back({0, double(i), i});
  }
  const auto serving = [&](std::size_t from) {
    int count = 0;
    for (std::size_t i = from; i < duties.size(); ++i) count += duties[i].role() == Role::kServing;
    return count;
  };
  for (std::int64_t ms = 0, first_alive = 0; ms <= 10'000; ms += 50) {
    if (ms == 5000) first_alive = 1;  // the first one dies
    for (std::size_t i = static_cast<std::size_t>(first_alive); i < duties.size(); ++i) {
      const Role before = duties[i].role();
      if (before == Role::kServing && ms % 200 == 0)
        for (std::size_t j = 0; j < duties.size(); ++j)
          if (i != j) duties[j].observe(claims[i], "box", true, (ms + 50) * kDutyMs);
      const Role now = duties[i].update(claims[i], ms * kDutyMs);
      if (now == Role::kServing && before != Role::kServing) claims[i].started_ns = ms;
    }
    if (ms >= 2000 && ms < 5000) {
      EXPECT_EQ(serving(0), 1) << ms;
    }
    if (ms >= 6500) {
      EXPECT_EQ(serving(1), 1) << ms;
    }
  }
}

}  // namespace
}  // namespace rtd::detector
