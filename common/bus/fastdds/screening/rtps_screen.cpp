// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/rtps_screen.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "common/bus/fastdds/screening/rtps_fragments.hpp"
#include "common/bus/fastdds/screening/rtps_numbers.hpp"

namespace rtd::bus {
namespace {

constexpr std::size_t kMessageHeader = 20, kSubmessageHeader = 4;
constexpr std::uint8_t kPad = 0x01, kInfoTimestamp = 0x09, kFirstOfVendors = 0x80;
/// RTPS 2.x, with those of DDS-Security.
constexpr std::uint8_t kKnown[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e, 0x0f,
                                   0x12, 0x13, 0x15, 0x16, 0x30, 0x31, 0x32, 0x33, 0x34};

std::uint8_t octet(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}

}  // namespace

bool is_rtps_message(std::span<const std::byte> datagram) {
  if (datagram.size() < kMessageHeader || std::memcmp(datagram.data(), "RTPS\2", 5) != 0) return false;
  std::size_t at = kMessageHeader;
  while (at < datagram.size()) {
    if (datagram.size() - at < kSubmessageHeader) return false;
    const std::uint8_t id = octet(datagram, at);
    const bool little_endian = (octet(datagram, at + 1) & 1U) != 0;
    const std::size_t first = octet(datagram, at + 2), second = octet(datagram, at + 3);
    const std::size_t length = little_endian ? first + 256 * second : 256 * first + second;
    at += kSubmessageHeader;
    if (length > datagram.size() - at) return false;
    // Of vendors' own submessages only one at the end is ever sent by the vendors that we know.
    if (id >= kFirstOfVendors) return at + length == datagram.size();
    if (std::find(std::begin(kKnown), std::end(kKnown), id) == std::end(kKnown)) return false;
    if (length == 0 && id != kPad && id != kInfoTimestamp) return true;  // the rest is its content
    if (at + length < datagram.size() && length % 4 != 0) return false;
    at += length;
  }
  return true;
}

bool RtpsScreen::passes(std::span<const std::byte> datagram) {
  if (!is_rtps_message(datagram) || !has_whole_fragments(datagram)) return false;
  const std::vector<WriterNumber> numbers = sequence_numbers_of(datagram);
  return std::all_of(numbers.begin(), numbers.end(),
                     [this](const WriterNumber& named) { return guard_.plausible(named.writer, named.number); });
}

}  // namespace rtd::bus
