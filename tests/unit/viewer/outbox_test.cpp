// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/outbox.hpp"

#include <gtest/gtest.h>

namespace rtd::viewer {
namespace {

Frame data(std::size_t bytes, int mark) {
  return binary_frame(Bytes(1, std::byte(mark)), std::make_shared<const Bytes>(bytes - 1));
}

int mark(const Frame& frame) {
  return std::to_integer<int>(frame.head.front());
}

TEST(Outbox, control_goes_before_data) {
  Outbox outbox;
  outbox.push_data(data(10, 1));
  EXPECT_TRUE(outbox.push_control(text_frame("hello")));
  EXPECT_TRUE(outbox.pop()->text);
  EXPECT_EQ(mark(*outbox.pop()), 1);
  EXPECT_FALSE(outbox.pop().has_value());
  EXPECT_EQ(outbox.bytes(), 0U);
}

TEST(Outbox, drops_the_oldest_data_and_counts) {
  Outbox outbox({.data_messages = 3, .data_bytes = 1000});
  for (int i = 1; i <= 5; ++i) outbox.push_data(data(10, i));
  EXPECT_EQ(outbox.dropped(), 2U);
  EXPECT_EQ(mark(*outbox.pop()), 3);
  outbox.push_data(data(995, 9));
  EXPECT_EQ(outbox.dropped(), 4U) << "no room beside it";
  EXPECT_EQ(mark(*outbox.pop()), 9);
}

TEST(Outbox, a_message_beyond_the_limit_waits_alone) {
  Outbox outbox({.data_bytes = 100});
  outbox.push_data(data(10, 1));
  outbox.push_data(data(5000, 2));
  EXPECT_EQ(outbox.bytes(), 5000U);
  EXPECT_EQ(mark(*outbox.pop()), 2);
}

TEST(Outbox, a_client_that_takes_no_control_messages_is_given_up) {
  Outbox outbox({.control_messages = 2});
  EXPECT_TRUE(outbox.push_control(text_frame("a")));
  EXPECT_TRUE(outbox.push_control(text_frame("b")));
  EXPECT_FALSE(outbox.push_control(text_frame("c")));
  EXPECT_TRUE(outbox.overflowed());
  Outbox small({.control_bytes = 10});
  EXPECT_FALSE(small.push_control(text_frame("longer than ten")));
}

}  // namespace
}  // namespace rtd::viewer
