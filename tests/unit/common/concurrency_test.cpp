// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <future>

#include "common/concurrency/bounded_queue.hpp"

namespace rtd::concurrency {
namespace {

using namespace std::chrono_literals;

TEST(BoundedQueue, newest_wins_and_counts_what_it_dropped) {
  BoundedQueue<int> queue(2, Overflow::kDropOldest);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(queue.push(i));
  EXPECT_EQ(queue.dropped(), 3U);
  EXPECT_EQ(queue.pop(), 3);
  EXPECT_EQ(queue.pop(), 4);
}

TEST(BoundedQueue, blocking_producer_loses_nothing) {
  BoundedQueue<int> queue(2, Overflow::kBlock);
  auto producer = std::async(std::launch::async, [&] {
    for (int i = 0; i < 1000; ++i) queue.push(i);
  });
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(queue.pop(), i);
  producer.get();
  EXPECT_EQ(queue.dropped(), 0U);
}

TEST(BoundedQueue, close_wakes_the_consumer_after_the_queue_is_drained) {
  BoundedQueue<int> queue(4, Overflow::kDropOldest);
  queue.push(1);
  queue.close();
  EXPECT_FALSE(queue.push(2));
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(BoundedQueue, close_wakes_a_blocked_producer) {
  BoundedQueue<int> queue(1, Overflow::kBlock);
  queue.push(1);
  auto producer = std::async(std::launch::async, [&] { return queue.push(2); });
  queue.close();
  EXPECT_FALSE(producer.get());
}

TEST(BoundedQueue, pop_for_gives_up) {
  BoundedQueue<int> queue(1, Overflow::kBlock);
  EXPECT_EQ(queue.pop_for(1ms), std::nullopt);
}

}  // namespace
}  // namespace rtd::concurrency
