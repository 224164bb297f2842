// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/rtps_screen.hpp"

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

RtpsMessage read(const std::vector<std::uint8_t>& datagram) {
  return read_rtps_message(std::as_bytes(std::span(datagram)));
}

bool passes(const std::vector<std::uint8_t>& datagram) {
  return read(datagram).well_formed;
}

TEST(RtpsScreenTest, lets_whole_messages_pass) {
  EXPECT_TRUE(passes(message({})));
  EXPECT_TRUE(passes(message(kInfoTimestamp)));
  EXPECT_TRUE(passes(message(join(kInfoTimestamp, statistics()))));
  EXPECT_TRUE(passes(message({0x15, 1, 0, 0, 9, 9, 9}))) << "length 0: to the end";
}

TEST(RtpsScreenTest, refuses_what_is_not_a_message) {
  EXPECT_FALSE(passes({}));
  EXPECT_FALSE(passes({'R', 'T', 'P', 'S', 2, 3}));
  auto other = message(kInfoTimestamp);
  other[0] = 'X';
  EXPECT_FALSE(passes(other));
  EXPECT_FALSE(passes(message({0x55, 1, 4, 0, 0, 0, 0, 0}))) << "no such submessage";
}

TEST(RtpsScreenTest, refuses_lengths_that_lie) {
  EXPECT_FALSE(passes(message({0x15, 1, 8, 0, 1, 2, 3, 4}))) << "longer than the datagram";
  EXPECT_FALSE(passes(message(join({0x15, 1, 5, 0, 1, 2, 3, 4, 5}, kInfoTimestamp)))) << "not a whole number of words";
  EXPECT_FALSE(passes(message({0x09, 1, 8}))) << "half a header";
}

TEST(RtpsScreenTest, leaves_out_the_last_submessage_whatever_it_is) {
  const auto without = [](const std::vector<std::uint8_t>& whole, std::size_t bytes) {
    return without_last(std::as_bytes(std::span(whole)), bytes).size();
  };
  const auto before = message(kInfoTimestamp);
  EXPECT_EQ(without(join(before, statistics()), 54), before.size());
  EXPECT_EQ(without(join(before, std::vector<std::uint8_t>(60, 0x6d)), 60), before.size()) << "it was never written";
  EXPECT_EQ(without(before, 12), before.size()) << "there is only one";
  EXPECT_EQ(without(join(before, kInfoTimestamp), 10), before.size() + 12) << "none of this size is at the end";
  EXPECT_EQ(without({}, 60), 0U);
}

TEST(RtpsScreenTest, refuses_a_vendors_submessage_before_the_end) {
  EXPECT_FALSE(passes(message(join(statistics(), kInfoTimestamp))));
}

std::vector<std::uint8_t> number(std::uint64_t value) {
  std::vector<std::uint8_t> octets;
  for (const int shift : {32, 40, 48, 56, 0, 8, 16, 24}) octets.push_back(static_cast<std::uint8_t>(value >> shift));
  return octets;
}

/// Of the writer with entity id 4, 5, 6, 7.
std::vector<std::uint8_t> heartbeat(std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint8_t> submessage = {0x07, 1, 28, 0, 0, 0, 0, 0, 4, 5, 6, 7};
  return join(join(join(submessage, number(first)), number(last)), {1, 0, 0, 0});
}

std::vector<std::uint8_t> data(std::uint64_t value) {
  return join({0x15, 1, 20, 0, 0, 0, 16, 0, 0, 0, 0, 0, 4, 5, 6, 7}, number(value));
}

std::vector<WriterNumber> numbers(const std::vector<std::uint8_t>& datagram) {
  return read(datagram).numbers;
}

TEST(RtpsNumbersTest, finds_the_largest_number_of_each_writer) {
  EXPECT_TRUE(numbers(message(kInfoTimestamp)).empty());
  const auto found = numbers(message(join(join(data(7), heartbeat(3, 0x500000009)), kInfoTimestamp)));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].number, 0x500000009U);
  EXPECT_EQ(found[0].writer[15], std::byte{7});
  const auto info_source = join({0x0c, 1, 20, 0}, std::vector<std::uint8_t>(20, 9));
  const auto two = numbers(message(join(join(data(7), info_source), data(8))));
  ASSERT_EQ(two.size(), 2U) << "the same entity of another participant";
  EXPECT_EQ(two[1].writer[0], std::byte{9});
}

TEST(RtpsNumbersTest, reads_big_endian_and_leaves_out_what_is_too_short) {
  const auto found = numbers(message({0x15, 0, 0, 20, 0, 0, 0, 16, 0, 0, 0, 0, 4, 5, 6, 7, 0, 0, 0, 0, 0, 0, 1, 2}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].number, 258U);
  EXPECT_TRUE(numbers(message({0x15, 1, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8})).empty());
  EXPECT_TRUE(numbers(message({0x15, 1, 0, 0, 9, 9, 9})).empty()) << "length 0: to the end";
}

struct Fragments {
  std::uint8_t first = 1, count = 1, size = 8, sample = 8, octets = 8, flags = 1;
  std::vector<std::uint8_t> qos = {};
};

std::vector<std::uint8_t> data_frag(const Fragments& f) {
  auto body = join(join({0, 0, 28, 0, 0, 0, 0, 0, 4, 5, 6, 7}, number(9)), {f.first, 0, 0, 0, f.count, 0, f.size, 0});
  body = join(join(join(body, {f.sample, 0, 0, 0}), f.qos), std::vector<std::uint8_t>(f.octets, 1));
  return join({0x16, f.flags, static_cast<std::uint8_t>(body.size()), 0}, body);
}

bool whole(const std::vector<std::uint8_t>& datagram) {
  return read(datagram).well_formed && read(datagram).whole_fragments;
}

bool whole(const Fragments& fragments) {
  return whole(message(data_frag(fragments)));
}

TEST(RtpsFragmentsTest, whole_ones_are_accepted) {
  EXPECT_TRUE(whole(Fragments{}));
  EXPECT_TRUE(whole(Fragments{.first = 2, .count = 2, .sample = 100, .octets = 16}));
  EXPECT_TRUE(whole(Fragments{.first = 2, .sample = 10, .octets = 4}))
      << "the last one is shorter, then filled to a word";
  const std::vector<std::uint8_t> qos = {2, 0, 4, 0, 9, 9, 9, 9, 1, 0, 0, 0};
  EXPECT_TRUE(whole(Fragments{.flags = 3, .qos = qos}));
  EXPECT_TRUE(whole(message(kInfoTimestamp)));
}

TEST(RtpsFragmentsTest, missing_ones_are_found) {
  EXPECT_FALSE(whole(Fragments{.octets = 4}));
  EXPECT_FALSE(whole(Fragments{.count = 12, .sample = 90, .octets = 16})) << "to the last one: more than is there";
  EXPECT_FALSE(whole(Fragments{.first = 0}));
  EXPECT_FALSE(whole(Fragments{.count = 0}));
  EXPECT_FALSE(whole(Fragments{.size = 0}));
  EXPECT_FALSE(whole(Fragments{.sample = 0}));
  EXPECT_FALSE(whole(Fragments{.first = 2})) << "behind the end of the sample";
  EXPECT_FALSE(whole(Fragments{.count = 2, .octets = 16})) << "half behind it";
  EXPECT_FALSE(whole(Fragments{.flags = 3})) << "a list of QoS without end";
  EXPECT_FALSE(whole(message({0x16, 1, 4, 0, 0, 0, 28, 0})));
}

/// A fragment of a sample of so many times 16 MiB of a writer of that kind.
std::vector<std::uint8_t> fragment_of(std::uint8_t first, std::uint8_t times_16_mib, std::uint8_t writer_kind) {
  constexpr std::size_t kBody = 20 + 4;
  std::vector<std::uint8_t> datagram = message(data_frag({.first = first}));
  datagram[kBody + 11] = writer_kind;
  datagram[kBody + 31] = times_16_mib;
  return datagram;
}

TEST(RtpsFragmentsTest, of_too_large_samples_the_first_alone_passes_for_readers_to_give_the_sample_up) {
  constexpr std::uint8_t kOfApplication = 0x03;
  EXPECT_TRUE(whole(fragment_of(2, 4 - 1, kOfApplication))) << "48 MiB";
  EXPECT_TRUE(whole(fragment_of(1, 0xff, kOfApplication))) << "4 GB";
  EXPECT_FALSE(whole(fragment_of(2, 0xff, kOfApplication)));
  EXPECT_FALSE(whole(fragment_of(2, 4, kOfApplication))) << "64 MiB and 8 bytes";
}

TEST(RtpsFragmentsTest, of_discovery_are_of_small_samples) {
  constexpr std::uint8_t kOfVendor = 0xc2;
  EXPECT_TRUE(whole(fragment_of(1, 0, kOfVendor)));
  EXPECT_FALSE(whole(fragment_of(1, 1, kOfVendor))) << "16 MiB";
}

TEST(NumberGuardTest, accepts_steps_and_repeated_far_numbers) {
  constexpr std::uint64_t kFar = NumberGuard::kFar, kDays = 40 * kFar;
  const WriterGuid writer{std::byte{1}}, other{std::byte{2}};
  NumberGuard guard;
  EXPECT_TRUE(guard.plausible(writer, 1));
  EXPECT_TRUE(guard.plausible(writer, kFar));
  EXPECT_TRUE(guard.plausible(writer, 2 * kFar));
  EXPECT_FALSE(guard.plausible(other, 2 * kFar)) << "each by itself";
  EXPECT_FALSE(guard.plausible(writer, ~std::uint64_t{0}));
  for (int i = 1; i < NumberGuard::kMessages; ++i) EXPECT_FALSE(guard.plausible(writer, kDays + 30));
  EXPECT_TRUE(guard.plausible(writer, 17)) << "a right one in between";
  for (std::uint64_t i = 1; i < NumberGuard::kMessages; ++i) EXPECT_FALSE(guard.plausible(writer, kDays + i));
  EXPECT_TRUE(guard.plausible(writer, kDays)) << "it has been writing for days";
  EXPECT_TRUE(guard.plausible(writer, kDays + kFar));
  EXPECT_TRUE(guard.plausible(writer, 18)) << "old ones are asked for again";
}

TEST(NumberGuardTest, remembers_no_more_writers_than_it_says) {
  NumberGuard guard;
  WriterGuid writer{};
  for (std::size_t i = 0; i < 3 * NumberGuard::kWriters; ++i) {
    writer[0] = static_cast<std::byte>(i);
    writer[1] = static_cast<std::byte>(i >> 8);
    EXPECT_TRUE(guard.plausible(writer, NumberGuard::kFar));
  }
  EXPECT_FALSE(guard.plausible(WriterGuid{}, 2 * NumberGuard::kFar + 1)) << "the first one was forgotten";
}

TEST(RtpsScreenTest, refuses_numbers_that_would_be_counted_to_for_hours) {
  const auto passes_screen = [](RtpsScreen& screen, const std::vector<std::uint8_t>& datagram) {
    return screen.passes(std::as_bytes(std::span(datagram)));
  };
  RtpsScreen screen;
  EXPECT_TRUE(passes_screen(screen, message(heartbeat(1, 5))));
  EXPECT_FALSE(passes_screen(screen, message(heartbeat(0x7fffffff, 0x7fffffff))));
  EXPECT_FALSE(passes_screen(screen, message(join(kInfoTimestamp, data(std::uint64_t{1} << 33)))));
  EXPECT_TRUE(passes_screen(screen, message(data(6))));
  EXPECT_FALSE(passes_screen(screen, {'R', 'T', 'P', 'S'}));
}

}  // namespace
}  // namespace rtd::bus
