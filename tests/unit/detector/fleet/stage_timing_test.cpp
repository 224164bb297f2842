// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/fleet/fleet_queue.hpp"

#include <gtest/gtest.h>

namespace rtd::detector {
namespace {

using std::chrono::milliseconds;
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

}  // namespace
}  // namespace rtd::detector
