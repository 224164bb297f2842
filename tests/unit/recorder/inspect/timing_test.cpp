// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/recording_report.hpp"

#include <gtest/gtest.h>

namespace rtd::recordings {
namespace {

TEST(Timing, reports_rate_median_and_the_gaps_of_a_channel) {
  const Timing timing = timing_of({0, 10, 20, 30, 60, 70, 95, 100});  // one period of 30, one of exactly 2.5 medians
  EXPECT_EQ(timing.messages, 8U);
  EXPECT_EQ(timing.median_period_ns, 10U);
  EXPECT_EQ(timing.largest_gap_ns, 30U);
  EXPECT_EQ(timing.largest_gap_at_ns, 30U);
  EXPECT_EQ(timing.gaps, 1U) << "2.5 medians are no gap yet";
  EXPECT_DOUBLE_EQ(timing.rate_hz, 7 * 1e9 / 100);
}

TEST(Timing, handles_no_message_one_and_many_at_one_time) {
  EXPECT_EQ(timing_of({}).messages, 0U);
  EXPECT_EQ(timing_of({5}).first_ns, 5U);
  EXPECT_EQ(timing_of({5}).rate_hz, 0);
  EXPECT_EQ(timing_of({5, 5, 5}).rate_hz, 0);
  EXPECT_EQ(timing_of({5, 5, 5}).gaps, 0U);
}

TEST(Timing, does_not_depend_on_the_order_in_the_file) {
  EXPECT_EQ(timing_of({20, 0, 10}).largest_gap_ns, 10U);
}

TEST(SequenceCount, counts_what_is_missing_and_writers_that_begin_again) {
  SequenceCount count;
  for (const std::uint32_t sequence : {4, 5, 8, 9}) count.add(sequence);
  EXPECT_EQ(count.missing(), 2U);
  for (const std::uint32_t sequence : {1, 2}) count.add(sequence);
  EXPECT_EQ(count.missing(), std::nullopt) << "several writers";
  EXPECT_EQ(count.gaps(), 1U);
  EXPECT_EQ(count.restarts(), 1U);
  EXPECT_TRUE(count.numbered());
}

TEST(SequenceCount, knows_a_recording_without_numbers) {
  SequenceCount count;
  for (int i = 0; i < 3; ++i) count.add(0);
  EXPECT_FALSE(count.numbered());
}

TEST(SharedCounter, is_recognised_by_numbers_that_only_all_channels_together_have) {
  EXPECT_EQ(missing_of_shared_counter({{1, 3, 5, 7}, {2, 4, 6}, {8}}), 0U);
  EXPECT_EQ(missing_of_shared_counter({{1, 3, 5, 9}, {2, 4, 6, 8}}), 1U) << "7 is lost";
  EXPECT_EQ(missing_of_shared_counter({{5, 3, 1}, {6, 2, 4}}), 0U) << "in any order";
}

TEST(SharedCounter, channels_that_count_for_themselves_are_distinguished) {
  EXPECT_EQ(missing_of_shared_counter({}), std::nullopt);
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 5}}), std::nullopt) << "one channel";
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 5}, {1, 2, 3}}), std::nullopt);
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 3}, {5000, 5001, 5003}}), std::nullopt) << "an older writer";
  EXPECT_EQ(missing_of_shared_counter({{1, 2, 3}, {4, 5}}), std::nullopt) << "nothing is missing in either";
}

}  // namespace
}  // namespace rtd::recordings
