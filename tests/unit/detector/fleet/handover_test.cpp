// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/fleet_pipeline.hpp"

#include <gtest/gtest.h>

#include <future>
#include <thread>

namespace rtd::detector {
namespace {

using namespace std::chrono_literals;
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

}  // namespace
}  // namespace rtd::detector
