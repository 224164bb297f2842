// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/rtps_submessage.hpp"

#include <algorithm>

namespace rtd::bus {
namespace {

constexpr std::size_t kMessageHeader = 20, kSubmessageHeader = 4;
constexpr int kPad = 0x01, kInfoTimestamp = 0x09;

}  // namespace

std::uint64_t RtpsSubmessage::integer(std::size_t at, std::size_t octets) const {
  const bool little_endian = (flags & 1U) != 0;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < octets; ++i)
    value = 256 * value + std::to_integer<std::uint64_t>(body[at + (little_endian ? octets - 1 - i : i)]);
  return value;
}

RtpsSubmessages::RtpsSubmessages(std::span<const std::byte> message)
    : rest_(message.subspan(std::min(kMessageHeader, message.size()))) {}

std::optional<RtpsSubmessage> RtpsSubmessages::next() {
  if (rest_.size() < kSubmessageHeader) return std::nullopt;
  RtpsSubmessage found;
  found.kind = std::to_integer<int>(rest_[0]);
  found.flags = std::to_integer<unsigned>(rest_[1]);
  found.body = rest_;
  const std::size_t length = found.half(2), room = rest_.size() - kSubmessageHeader;
  const bool to_the_end = length == 0 && found.kind != kPad && found.kind != kInfoTimestamp;
  found.body = rest_.subspan(kSubmessageHeader, to_the_end ? room : std::min(length, room));
  rest_ = rest_.subspan(kSubmessageHeader + found.body.size());
  return found;
}

}  // namespace rtd::bus
