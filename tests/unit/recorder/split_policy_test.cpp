// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/output_files.hpp"

#include <gtest/gtest.h>

namespace rtd::recorder {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

TEST(SplitPolicy, reads_sizes_and_times) {
  EXPECT_EQ(parse_split("500MB")->bytes, 500'000'000U);
  EXPECT_EQ(parse_split("1GiB")->bytes, 1ULL << 30);
  EXPECT_EQ(parse_split("1.5gb")->bytes, 1'500'000'000U);
  EXPECT_EQ(parse_split("60s")->duration_ns, 60 * kSecond);
  EXPECT_EQ(parse_split("5min")->duration_ns, 300 * kSecond);
  EXPECT_EQ(parse_split("2h")->duration_ns, 7200 * kSecond);
  for (const char* nonsense : {"", "1", "GB", "-1GB", "0s", "1 GB", "1XB", "nanGB", "1e30GB", "1GBs"}) {
    EXPECT_FALSE(parse_split(nonsense)) << nonsense;
  }
}

TEST(SplitPolicy, by_size_a_file_stays_below) {
  const SplitPolicy policy{1000, 0};
  EXPECT_TRUE(policy.has_room(900, 100, 0, 0));
  EXPECT_FALSE(policy.has_room(900, 101, 0, 0));
}

TEST(SplitPolicy, by_time_a_file_covers_less) {
  const SplitPolicy policy{0, 10 * kSecond};
  EXPECT_TRUE(policy.has_room(1 << 30, 1 << 30, 5 * kSecond, 15 * kSecond - 1));
  EXPECT_FALSE(policy.has_room(0, 0, 5 * kSecond, 15 * kSecond));
  EXPECT_TRUE(policy.has_room(0, 0, 5 * kSecond, 4 * kSecond)) << "a message out of order";
}

TEST(SplitPolicy, never_without_a_limit) {
  EXPECT_FALSE(SplitPolicy{}.on());
  EXPECT_TRUE(SplitPolicy{}.has_room(~0ULL / 2, 1, 0, ~0ULL));
}

}  // namespace
}  // namespace rtd::recorder
