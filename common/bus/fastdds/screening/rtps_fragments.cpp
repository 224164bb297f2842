// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/rtps_fragments.hpp"

#include <algorithm>

#include "common/bus/fastdds/screening/rtps_submessage.hpp"

namespace rtd::bus {
namespace {

constexpr std::size_t kOffsetToQos = 2, kBehindOffset = 4, kFirstFragment = 20, kFragments = 24, kFragmentSize = 26,
                      kSampleSize = 28, kHeader = 32;
constexpr unsigned kHasQos = 2;
constexpr std::uint16_t kSentinel = 1;

/// Where the list of parameters at `at` ends; 0: nowhere in the submessage.
std::size_t behind_parameters(const RtpsSubmessage& submessage, std::size_t at) {
  while (at + 4 <= submessage.body.size()) {
    const std::uint16_t parameter = submessage.half(at), length = submessage.half(at + 2);
    at += 4;
    if (parameter == kSentinel) return at;
    at += length;
  }
  return 0;
}

bool is_whole(const RtpsSubmessage& submessage) {
  if (submessage.body.size() < kHeader) return false;
  const std::uint64_t first = submessage.word(kFirstFragment), count = submessage.half(kFragments),
                      size = submessage.half(kFragmentSize), sample = submessage.word(kSampleSize);
  if (first == 0 || count == 0 || size == 0 || sample == 0 || sample > kMaxFragmentedSample) return false;
  const std::uint64_t begin = (first - 1) * size, end = std::min((first + count - 1) * size, sample);
  if (begin >= sample || (first + count - 2) * size >= sample) return false;
  std::size_t payload = std::max(kHeader, kBehindOffset + submessage.half(kOffsetToQos));
  if ((submessage.flags & kHasQos) != 0) payload = behind_parameters(submessage, payload);
  return payload >= kHeader && payload <= submessage.body.size() && submessage.body.size() - payload >= end - begin;
}

}  // namespace

bool has_whole_fragments(std::span<const std::byte> message) {
  RtpsSubmessages submessages(message);
  while (const auto submessage = submessages.next())
    if (submessage->kind == RtpsSubmessage::kDataFrag && !is_whole(*submessage)) return false;
  return true;
}

}  // namespace rtd::bus
