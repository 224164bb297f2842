// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/rtps_screen.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace rtd::bus {
namespace {

/// A message of Fast DDS 2.9: INFO_TS, DATA and the vendor's statistics of 50 octets at the end.
std::vector<std::uint8_t> message(const std::vector<std::uint8_t>& submessages) {
  std::vector<std::uint8_t> all = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
  all.resize(20);
  for (const std::uint8_t octet : submessages) all.push_back(octet);
  return all;
}

const std::vector<std::uint8_t> kInfoTimestamp = {0x09, 1, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8};

std::vector<std::uint8_t> statistics() {
  std::vector<std::uint8_t> submessage = {0x80, 0, 0, 50};
  submessage.resize(54);
  return submessage;
}

std::vector<std::uint8_t> join(std::vector<std::uint8_t> one, const std::vector<std::uint8_t>& other) {
  for (const std::uint8_t octet : other) one.push_back(octet);
  return one;
}

bool passes(const std::vector<std::uint8_t>& datagram) {
  return is_rtps_message(std::as_bytes(std::span(datagram)));
}

TEST(RtpsScreenTest, lets_whole_messages_pass) {
  EXPECT_TRUE(passes(message({})));
  EXPECT_TRUE(passes(message(kInfoTimestamp)));
  EXPECT_TRUE(passes(message(join(kInfoTimestamp, statistics()))));
  EXPECT_TRUE(passes(message({0x15, 1, 0, 0, 9, 9, 9}))) << "length 0: to the end";
}

TEST(RtpsScreenTest, refuses_what_is_no_message) {
  EXPECT_FALSE(passes({}));
  EXPECT_FALSE(passes({'R', 'T', 'P', 'S', 2, 3}));
  auto other = message(kInfoTimestamp);
  other[0] = 'X';
  EXPECT_FALSE(passes(other));
  EXPECT_FALSE(passes(message({0x55, 1, 4, 0, 0, 0, 0, 0}))) << "no such submessage";
}

TEST(RtpsScreenTest, refuses_lengths_that_lie) {
  EXPECT_FALSE(passes(message({0x15, 1, 8, 0, 1, 2, 3, 4}))) << "longer than the datagram";
  EXPECT_FALSE(passes(message(join({0x15, 1, 5, 0, 1, 2, 3, 4, 5}, kInfoTimestamp)))) << "no whole words";
  EXPECT_FALSE(passes(message({0x09, 1, 8}))) << "half a header";
}

TEST(RtpsScreenTest, refuses_a_vendors_submessage_before_the_end) {
  EXPECT_FALSE(passes(message(join(statistics(), kInfoTimestamp))));
}

}  // namespace
}  // namespace rtd::bus
