// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/core/topic_report.hpp"

#include <gtest/gtest.h>

namespace rtd::topics {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(RateMeter, gives_rate_and_spread_of_the_periods) {
  RateMeter meter;
  for (const std::int64_t at_ms : {100, 130, 170, 200}) meter.add(at_ms * kMs, 50);
  const Rate rate = meter.rate();
  EXPECT_EQ(rate.messages, 4U);
  EXPECT_EQ(rate.bytes, 200U);
  EXPECT_NEAR(rate.hz, 30, 1e-9);
  EXPECT_NEAR(rate.mean_ms, 100.0 / 3, 1e-9);
  EXPECT_NEAR(rate.deviation_ms, 4.714045, 1e-5);  // of 30, 40, 30
  EXPECT_EQ(rate.shortest_ms, 30);
  EXPECT_EQ(rate.longest_ms, 40);
}

TEST(RateMeter, a_single_message_has_no_rate) {
  RateMeter meter;
  EXPECT_EQ(meter.rate().messages, 0U);
  meter.add(5, 10);
  meter.add_lost(3);
  EXPECT_EQ(meter.rate().hz, 0);
  EXPECT_EQ(meter.rate().messages, 1U);
  EXPECT_EQ(meter.rate().lost, 3U);
}

}  // namespace
}  // namespace rtd::topics
