// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/player.hpp"

#include <gtest/gtest.h>

namespace rtd::replay {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(Schedule, plays_at_the_rate_from_where_it_was_put) {
  Schedule schedule(2);
  schedule.jump(100 * kSecond, 7 * kSecond);
  EXPECT_EQ(schedule.due_ns(100 * kSecond), 7 * kSecond);
  EXPECT_EQ(schedule.due_ns(110 * kSecond), 12 * kSecond);
  EXPECT_EQ(schedule.recorded_ns(12 * kSecond), 110 * kSecond);
}

TEST(Schedule, a_pause_moves_what_follows_by_its_length) {
  Schedule schedule(1);
  schedule.jump(0, 0);
  schedule.pause(3 * kSecond);
  EXPECT_EQ(schedule.recorded_ns(9 * kSecond), 3 * kSecond);
  schedule.resume(10 * kSecond);
  EXPECT_EQ(schedule.due_ns(5 * kSecond), 12 * kSecond);
}

TEST(Schedule, another_rate_counts_from_now_on) {
  Schedule schedule(1);
  schedule.jump(0, 0);
  schedule.set_rate(0.5, 4 * kSecond);
  EXPECT_EQ(schedule.recorded_ns(4 * kSecond), 4 * kSecond);
  EXPECT_EQ(schedule.due_ns(5 * kSecond), 6 * kSecond);
}

TEST(Schedule, is_exact_after_a_day) {
  Schedule schedule(1);
  schedule.jump(0, 123);
  const std::int64_t day_ns = 86'400 * kSecond;
  EXPECT_EQ(schedule.due_ns(day_ns + 1), day_ns + 124);
}

TEST(TimingError, compares_distances_so_that_a_common_delay_is_no_error) {
  TimingError error;
  for (std::int64_t i = 0; i < 100; ++i) error.add(i * 1'000'000, i * 1'000'000 + 5'000'000);
  EXPECT_EQ(error.count(), 99U);
  EXPECT_LE(error.percentile_ms(100), 0.01);
  error.add(100'000'000, 107'000'000);
  EXPECT_NEAR(error.max_ms(), 2, 1e-9);
  EXPECT_LE(error.percentile_ms(90), 0.01);
  EXPECT_NEAR(error.percentile_ms(100), 2, 0.011);
}

TEST(TimingError, an_interruption_is_not_measured) {
  TimingError error;
  error.add(0, 0);
  error.interrupt();
  error.add(1'000'000, 90'000'000);
  EXPECT_EQ(error.count(), 0U);
  EXPECT_EQ(error.percentile_ms(99), 0);
}

}  // namespace
}  // namespace rtd::replay
