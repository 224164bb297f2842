// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "common/bus/cyclonedds/endpoints.hpp"

namespace rtd::bus::cyclonedds {
namespace {

constexpr std::size_t kKindAt = 20, kBodyAt = kKindAt + 4, kSizeAt = kKindAt + 32;
constexpr std::uint8_t kDataFrag = 0x16, kPad = 0x01;
const WriterId kWriter = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 5, 6, 7};

/// One fragment of 8 bytes of a sample of 100.
std::vector<std::uint8_t> datagram(std::uint8_t fragment) {
  const std::vector<std::uint8_t> body = {0,        0, 28, 0, 0, 0, 0, 0, 4,   5, 6, 7, 0, 0, 0, 0, 9, 0, 0, 0,
                                          fragment, 0, 0,  0, 1, 0, 8, 0, 100, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  std::vector<std::uint8_t> all = {'R', 'T', 'P', 'S', 2, 3, 1, 16};
  all.resize(kBodyAt);
  all[kKindAt] = kDataFrag;
  all[kKindAt + 1] = 1;
  all[kKindAt + 2] = static_cast<std::uint8_t>(body.size());
  all.insert(all.end(), body.begin(), body.end());
  return all;
}

std::vector<std::uint8_t> marked(const SampleLimits& limits, std::uint8_t fragment) {
  auto bytes = datagram(fragment);
  limits.mark_too_large(std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

TEST(SampleLimits, make_the_first_fragment_of_a_too_large_sample_huge_and_the_others_padding) {
  SampleLimits limits;
  limits.note(&limits, {kWriter}, 99);
  const auto first = marked(limits, 1), second = marked(limits, 2);
  EXPECT_EQ(first[kKindAt], kDataFrag);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(first[kSizeAt + i], 0xff);
  EXPECT_EQ(second[kKindAt], kPad);
}

TEST(SampleLimits, leave_alone_what_a_reader_takes_and_writers_of_none) {
  SampleLimits limits;
  EXPECT_EQ(marked(limits, 1), datagram(1));
  limits.note(&limits, {kWriter}, 100);
  EXPECT_EQ(marked(limits, 2), datagram(2));
  const int another_reader = 0;
  limits.note(&another_reader, {kWriter}, 10);
  EXPECT_EQ(limits.of(kWriter), 100U);
  limits.note(&limits, {}, 100);
  EXPECT_EQ(limits.of(kWriter), 10U);
  limits.note(&another_reader, {}, 10);
  EXPECT_EQ(limits.of(kWriter), std::nullopt);
}

}  // namespace
}  // namespace rtd::bus::cyclonedds
