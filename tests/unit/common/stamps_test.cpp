// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/msg/stamps.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace rtd::msg {
namespace {

constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min(), kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::array<std::int64_t, 9> kStamps{
    kMin, kMin + 1, -4'000'000'000'000'000'000, -1, 0, 1, 4'000'000'000'000'000'000, kMax - 1, kMax};

TEST(Stamps, ordinary_ones_are_added_and_subtracted) {
  EXPECT_EQ(minus_ns(1'700'000'000'033'333'333, 1'700'000'000'000'000'000), 33'333'333);
  EXPECT_EQ(minus_ns(5, 8), -3);
  EXPECT_EQ(plus_ns(-5, 8), 3);
  EXPECT_EQ(apart_ns(5, 8), 3);
  EXPECT_EQ(apart_ns(8, 5), 3);
  EXPECT_DOUBLE_EQ(minus_s(2'500'000'000, 1'000'000'000), 1.5);
  EXPECT_EQ(ns_of(0.25), 250'000'000);
}

TEST(Stamps, any_two_are_the_nearest_number_apart_that_has_room) {
  EXPECT_EQ(minus_ns(kMax, kMin), kMaxNs);
  EXPECT_EQ(minus_ns(kMin, kMax), -kMaxNs);
  EXPECT_EQ(minus_ns(kMin, 0), -kMaxNs) << "its sign can be changed";
  EXPECT_EQ(minus_ns(0, kMin), kMaxNs);
  EXPECT_EQ(plus_ns(kMax, 1), kMaxNs);
  EXPECT_EQ(plus_ns(kMin, -1), -kMaxNs);
  EXPECT_EQ(plus_ns(kMin, 0), -kMaxNs);
  EXPECT_EQ(apart_ns(kMin, kMax), kMaxNs);
}

TEST(Stamps, differences_keep_the_order) {
  for (const std::int64_t a : kStamps) {
    for (const std::int64_t b : kStamps) {
      EXPECT_EQ(minus_ns(a, b) > 0, a > b) << a << " " << b;
      EXPECT_EQ(minus_ns(a, b), -minus_ns(b, a)) << a << " " << b;
      EXPECT_GE(apart_ns(a, b), 0);
    }
  }
}

TEST(Stamps, seconds_that_have_no_room_are_bounded) {
  EXPECT_GT(ns_of(1e300), 9'000'000'000'000'000'000);
  EXPECT_LT(ns_of(-1e300), -9'000'000'000'000'000'000);
  EXPECT_GT(ns_of(HUGE_VAL), 9'000'000'000'000'000'000);
  EXPECT_EQ(ns_of(std::nan("")), 0);
}

}  // namespace
}  // namespace rtd::msg
