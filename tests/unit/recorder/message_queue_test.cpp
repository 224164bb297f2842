// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/message_queue.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace rtd::recorder {
namespace {

using namespace std::chrono_literals;

QueuedMessage message(std::uint32_t sequence, std::size_t size) {
  auto block = std::make_shared<bus::ByteBlock>();
  block->assign(std::vector<std::byte>(size));
  return {0, sequence, 0, 0, std::move(block)};
}

TEST(MessageQueue, keeps_order_and_refuses_the_newest_when_full) {
  MessageQueue queue(1000);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_TRUE(queue.push(message(i, 100)));
  EXPECT_FALSE(queue.push(message(10, 1)));
  EXPECT_EQ(queue.bytes(), 1000U);
  EXPECT_EQ(queue.pop()->sequence, 0U);
  EXPECT_TRUE(queue.push(message(11, 100)));
  for (const std::uint32_t sequence : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U, 11U}) {
    EXPECT_EQ(queue.pop()->sequence, sequence);
  }
  EXPECT_EQ(queue.bytes(), 0U);
}

TEST(MessageQueue, images_leave_room_for_poses) {
  MessageQueue queue(8 * 100'000);
  for (std::uint32_t i = 0; i < 7; ++i) EXPECT_TRUE(queue.push(message(i, 100'000)));
  EXPECT_FALSE(queue.push(message(7, 100'000)));
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_TRUE(queue.push(message(i, 1000)));
  EXPECT_FALSE(queue.push(message(0, 1000)));
}

TEST(MessageQueue, closed_it_gives_out_what_it_has) {
  MessageQueue queue(1000);
  queue.push(message(1, 10));
  queue.close();
  queue.wait_for(10s);  // does not
  EXPECT_FALSE(queue.push(message(2, 10)));
  EXPECT_EQ(queue.pop()->sequence, 1U);
  EXPECT_FALSE(queue.pop());
}

}  // namespace
}  // namespace rtd::recorder
