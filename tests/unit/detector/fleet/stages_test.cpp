// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <vector>

#include "services/detector/core/fleet/duty.hpp"
#include "services/detector/core/fleet/fleet_queue.hpp"
#include "services/detector/fleet_pipeline.hpp"

namespace rtd::detector {
namespace {

using std::chrono::milliseconds;
using namespace std::chrono_literals;

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

constexpr std::int64_t kTimingMs = 1'000'000;

TEST(StageTiming, begins_at_once_while_nothing_is_known) {
  EXPECT_EQ(StageTiming().delay(8), milliseconds(0));
}

TEST(StageTiming, decoding_ends_when_the_network_does) {
  StageTiming timing;
  for (int i = 0; i < 50; ++i) {
    timing.decoded(10 * kTimingMs);
    timing.inferred(4, 400 * kTimingMs);
  }
  EXPECT_EQ(timing.delay(2), milliseconds(190));
  EXPECT_EQ(timing.delay(8), milliseconds(790));
}

TEST(StageTiming, begins_at_once_when_decoding_takes_longer_than_the_network) {
  StageTiming timing;
  timing.decoded(10 * kTimingMs);
  timing.inferred(8, 8 * kTimingMs);
  EXPECT_EQ(timing.delay(8), milliseconds(0));
}

TEST(StageTiming, follows_a_network_that_becomes_slower) {
  StageTiming timing;
  timing.inferred(1, 10 * kTimingMs);
  for (int i = 0; i < 20; ++i) timing.inferred(1, 50 * kTimingMs);
  EXPECT_NEAR(static_cast<double>(timing.delay(1).count()), 50e6, 1e6);
}

using Clock = Handover<int>::Clock;

TEST(Handover, gives_what_was_put) {
  Handover<int> handover;
  ASSERT_TRUE(handover.wait_free());
  handover.put(7);
  EXPECT_EQ(handover.take_for(0ms), 7);
  EXPECT_EQ(handover.take_for(0ms), std::nullopt);
}

TEST(Handover, the_place_is_free_from_the_time_of_taking_on) {
  Handover<int> handover;
  handover.put(7);
  auto free = std::async(std::launch::async, [&] { return handover.wait_free(); });
  EXPECT_EQ(free.wait_for(20ms), std::future_status::timeout);
  const auto before = Clock::now();
  handover.take_for(0ms);
  const auto taken = free.get();
  ASSERT_TRUE(taken);
  EXPECT_GE(*taken, before);
  EXPECT_LE(*taken, Clock::now());
}

TEST(Handover, waits_for_the_taker_or_for_the_time) {
  Handover<int> handover;
  const auto latest = Clock::now() + 20ms;
  handover.wait_wanted(latest);
  EXPECT_GE(Clock::now(), latest);
  auto taker = std::async(std::launch::async, [&] { return handover.take_for(20s); });
  handover.wait_wanted(Clock::now() + 20s);  // returns because the taker waits
  handover.put(8);
  EXPECT_EQ(taker.get(), 8);
}

TEST(Handover, closing_ends_all_waiting) {
  Handover<int> full, empty;
  full.put(1);
  auto free = std::async(std::launch::async, [&] { return full.wait_free().has_value(); });
  auto taken = std::async(std::launch::async, [&] { return empty.take_for(20s).has_value(); });
  full.close();
  empty.close();
  EXPECT_FALSE(free.get());
  EXPECT_FALSE(taken.get());
}

TEST(ShareParts, runs_each_part_once) {
  for (const int threads : {1, 2, 5}) {
    for (std::size_t parts = 0; parts < 200; ++parts) {
      std::vector<std::atomic<int>> runs(parts);
      share_parts(parts, threads, [&](std::size_t part) { ++runs[part]; });
      EXPECT_TRUE(std::ranges::all_of(runs, [](const auto& count) { return count == 1; })) << parts;
    }
  }
}

TEST(ShareParts, works_on_several_parts_at_a_time) {
  std::atomic<int> waiting{0};
  share_parts(3, 3, [&](std::size_t) {
    ++waiting;
    while (waiting < 3) std::this_thread::yield();  // ends only when all three are at work
  });
  EXPECT_EQ(waiting, 3);
}

}  // namespace
}  // namespace rtd::detector
