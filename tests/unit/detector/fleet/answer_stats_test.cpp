// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/fleet/duty.hpp"

#include <gtest/gtest.h>

namespace rtd::detector {
namespace {

constexpr std::int64_t kStatsMs = 1'000'000;

TEST(AnswerStats, without_answers_all_is_zero) {
  AnswerStats stats;
  EXPECT_EQ(stats.summary(1000 * kStatsMs).rate_hz, 0);
  EXPECT_EQ(stats.summary(1000 * kStatsMs).latency_p99_ms, 0);
}

TEST(AnswerStats, summarises_the_last_seconds) {
  AnswerStats stats;
  for (int i = 0; i < 300; ++i) {  // 10 s at 30 Hz; the first half is slow
    const std::int64_t answered_ns = 1000 * kStatsMs + i * 100 * kStatsMs / 3;
    stats.add(answered_ns - (i < 150 ? 500 : 10 + i % 10) * kStatsMs, answered_ns, i % 2 == 0 ? 2 : 4);
  }
  const AnswerSummary summary = stats.summary(11'000 * kStatsMs);
  EXPECT_NEAR(summary.rate_hz, 30, 0.5);
  EXPECT_NEAR(summary.latency_p50_ms, 15, 1);
  EXPECT_NEAR(summary.latency_p99_ms, 19, 1);
  EXPECT_NEAR(summary.batch_mean, 3, 0.05);
}

TEST(AnswerStats, the_rate_of_a_robot_that_has_just_come_counts_from_its_first_answer) {
  AnswerStats stats;
  for (int i = 0; i <= 20; ++i) stats.add(0, 1000 * kStatsMs + i * 50 * kStatsMs, 1);
  EXPECT_NEAR(stats.summary(2000 * kStatsMs).rate_hz, 20, 1.1);
}

TEST(AnswerStats, the_first_answers_make_no_high_rate) {
  AnswerStats stats;
  stats.add(0, 1000 * kStatsMs, 1);
  stats.add(0, 1001 * kStatsMs, 1);
  EXPECT_NEAR(stats.summary(1002 * kStatsMs).rate_hz, 2, 0.1);
}

TEST(AnswerStats, a_robot_that_gets_no_answers_any_more_has_rate_zero) {
  AnswerStats stats;
  stats.add(0, 1000 * kStatsMs, 1);
  EXPECT_EQ(stats.summary(7000 * kStatsMs).rate_hz, 0);
}

TEST(AnswerStats, many_answers_are_counted_by_the_time_that_they_took) {
  AnswerStats stats;
  for (int i = 0; i < 10'000; ++i) stats.add(0, 1000 * kStatsMs + i * kStatsMs, 8);
  EXPECT_NEAR(stats.summary(11'000 * kStatsMs).rate_hz, 1000, 5);
}

}  // namespace
}  // namespace rtd::detector
