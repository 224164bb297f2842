// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/rtps/rtps_datagram.hpp"

#include <algorithm>
#include <cstring>

namespace rtd::fuzz {
namespace {

constexpr std::size_t kRtpsHeader = 20, kSubmessageHeader = 4;
constexpr int kAckNack = 0x06, kNackFrag = 0x12, kHeartbeatFrag = 0x13, kGap = 0x08, kHeartbeat = 0x07,
              kInfoDestination = 0x0e, kData = 0x15, kDataFrag = 0x16;

struct Submessage {
  int id;
  std::size_t at, end;  ///< header included
  bool little_endian;
};

std::vector<Submessage> submessages_of(const Bytes& datagram) {
  std::vector<Submessage> all;
  std::size_t at = kRtpsHeader;
  while (at + kSubmessageHeader <= datagram.size()) {
    const bool little = (std::to_integer<unsigned>(datagram[at + 1]) & 1U) != 0;
    const auto low = std::to_integer<std::size_t>(datagram[at + (little ? 2 : 3)]);
    const auto high = std::to_integer<std::size_t>(datagram[at + (little ? 3 : 2)]);
    const std::size_t length = low + 256 * high;
    const std::size_t end = length == 0 ? datagram.size() : std::min(datagram.size(), at + kSubmessageHeader + length);
    all.push_back({std::to_integer<int>(datagram[at]), at, end, little});
    at = end;
  }
  return all;
}

/// Where the reader's entity id stands; 0: it has none.
std::size_t reader_at(const Submessage& submessage) {
  const std::size_t body = submessage.at + kSubmessageHeader;
  if (submessage.id == kData || submessage.id == kDataFrag) return body + 4;  // behind flags and the offset to QoS
  return submessage.id == kHeartbeat || submessage.id == kGap ? body : 0;
}

/// Numbers that make parsers stumble.
std::uint32_t awkward_number(std::mt19937_64& random) {
  constexpr std::uint32_t kNumbers[] = {0,          1,          2,          255,        256,        257,
                                        0x7fff,     0x8000,     0xffff,     0x10000,    0x7fffffff, 0x80000000,
                                        0xfffffff0, 0xfffffffc, 0xffffffff, 0x01000000, 0x40000000, 0x20};
  return kNumbers[random() % std::size(kNumbers)];
}

void put_number(Bytes& datagram, const Submessage& submessage, std::mt19937_64& random) {
  const std::size_t words = (submessage.end - submessage.at) / 4;
  if (words < 2) return;
  const std::size_t at = submessage.at + 4 * (1 + random() % (words - 1));
  const std::uint32_t number = awkward_number(random);
  std::memcpy(&datagram[at], &number, random() % 2 == 0 ? 4 : 2);
}

void put_length(Bytes& datagram, const Submessage& submessage, std::mt19937_64& random) {
  const auto length = static_cast<std::uint16_t>(random() % 3 == 0 ? awkward_number(random)
                                                                   : submessage.end - submessage.at + random() % 9 - 8);
  std::memcpy(&datagram[submessage.at + 2], &length, 2);
}

void repeat(Bytes& datagram, const Submessage& submessage, std::mt19937_64& random) {
  const Bytes copy(datagram.begin() + static_cast<std::ptrdiff_t>(submessage.at),
                   datagram.begin() + static_cast<std::ptrdiff_t>(submessage.end));
  const auto count = 1 + random() % 20;
  for (std::size_t i = 0; i < count && datagram.size() + copy.size() < 60000; ++i)
    datagram.insert(datagram.end(), copy.begin(), copy.end());
}

}  // namespace

std::string kind_of(const Bytes& datagram) {
  std::string kind;
  for (const Submessage& submessage : submessages_of(datagram)) {
    kind += static_cast<char>(submessage.id);
    const bool of_reader = submessage.id == kAckNack || submessage.id == kNackFrag || submessage.id == kHeartbeatFrag;
    const std::size_t at = of_reader ? submessage.at + kSubmessageHeader : reader_at(submessage);
    if (at != 0 && at + 8 <= submessage.end) kind.append(reinterpret_cast<const char*>(&datagram[at]), 8);
  }
  return kind;
}

void address_to_any_reader(Bytes& datagram, std::mt19937_64& random) {
  const bool any_reader = random() % 2 == 0;
  for (const Submessage& submessage : submessages_of(datagram)) {
    const auto zero = [&](std::size_t at, std::size_t bytes) {
      if (at + bytes <= submessage.end)
        std::fill_n(datagram.begin() + static_cast<std::ptrdiff_t>(at), bytes, std::byte{});
    };
    if (submessage.id == kInfoDestination) zero(submessage.at + kSubmessageHeader, 12);
    if (const std::size_t at = reader_at(submessage); any_reader && at != 0) zero(at, 4);
  }
}

void mutate_submessages(Bytes& datagram, std::mt19937_64& random) {
  const auto changes = 1 + random() % 3;
  for (std::size_t i = 0; i < changes; ++i) {
    const std::vector<Submessage> all = submessages_of(datagram);
    if (all.empty()) return;
    const Submessage& submessage = all[random() % all.size()];
    switch (random() % 8) {
      case 0:
        put_length(datagram, submessage, random);
        break;
      case 1:  // flags: byte order, inline QoS, data, key
        datagram[submessage.at + 1] ^= std::byte{static_cast<unsigned char>(1U << (random() % 8))};
        break;
      case 2:  // another kind of submessage
        datagram[submessage.at] = std::byte{static_cast<unsigned char>(random() % 0x3a)};
        break;
      case 3:
        repeat(datagram, submessage, random);
        break;
      case 4:  // cut
        datagram.resize(submessage.at + random() % (submessage.end - submessage.at + 1));
        break;
      default:
        put_number(datagram, submessage, random);
        break;
    }
  }
}

}  // namespace rtd::fuzz
