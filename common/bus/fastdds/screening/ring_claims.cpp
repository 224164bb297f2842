// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/ring_claims.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

#include "common/bus/host/shm_names.hpp"

namespace rtd::bus {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t kPrefix = 12, kGuid = 16;

/// Where `wanted` begins in it, from `from` on; its size: nowhere.
std::size_t find(Bytes bytes, Bytes wanted, std::size_t from = 0) {
  const auto found =
      std::search(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(), wanted.begin(), wanted.end());
  return static_cast<std::size_t>(found - bytes.begin());
}

/// A number as it is sent in each byte order.
std::array<std::array<std::byte, 8>, 2> both_orders(std::uint64_t id) {
  std::array<std::array<std::byte, 8>, 2> orders;
  std::memcpy(orders[0].data(), &id, sizeof(id));
  std::reverse_copy(orders[0].begin(), orders[0].end(), orders[1].begin());
  return orders;
}

/// As Fast DDS names it: "fast_datasharing_01.0f.7f.01.a7.19.36.14.20.00.00.00_0.0.1.3".
std::string file_of(Bytes guid) {
  std::string name(kShmRing);
  for (std::size_t i = 0; i < kGuid; ++i) {
    char text[8];
    if (i > 0) name += i == kPrefix ? '_' : '.';
    std::snprintf(text, sizeof(text), i < kPrefix ? "%02x" : "%x", std::to_integer<unsigned>(guid[i]));
    name += text;
  }
  return name;
}

/// Of the writers that announce writers and readers (RTPS 2.2, 9.3.1.3).
bool announces_endpoints(Bytes entity) {
  constexpr std::array<std::byte, 4> kWriters{std::byte{0}, std::byte{0}, std::byte{3}, std::byte{0xc2}},
      kReaders{std::byte{0}, std::byte{0}, std::byte{4}, std::byte{0xc2}};
  return std::ranges::equal(entity, kWriters) || std::ranges::equal(entity, kReaders);
}

}  // namespace

std::optional<std::vector<std::byte>> RingClaims::checked(Bytes message) const {
  constexpr std::size_t kMessageHeader = 20, kHeader = 4, kWriter = 8, kEntity = 4;
  constexpr std::byte kDataFrag{0x16};
  std::vector<std::byte> changed;
  if (folder_.empty()) return changed;
  for (std::size_t at = kMessageHeader; at + kHeader <= message.size();) {
    const bool little_endian = (message[at + 1] & std::byte{1}) != std::byte{0};
    const auto low = std::to_integer<std::size_t>(message[at + (little_endian ? 2 : 3)]);
    const auto high = std::to_integer<std::size_t>(message[at + (little_endian ? 3 : 2)]);
    const std::size_t room = message.size() - at - kHeader, length = 256 * high + low;
    const Bytes body = message.subspan(at + kHeader, length == 0 ? room : std::min(length, room));
    if (body.size() >= kWriter + kEntity && announces_endpoints(body.subspan(kWriter, kEntity))) {
      if (message[at] == kDataFrag) return std::nullopt;
      for (const auto& id : both_orders(id_)) {
        for (std::size_t claim = find(body, id); claim < body.size(); claim = find(body, id, claim + 1)) {
          if (all_have_rings(body, claim)) continue;
          if (changed.empty()) changed.assign(message.begin(), message.end());
          std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(at + kHeader + claim), id.size(), std::byte{0});
        }
      }
    }
    at += kHeader + body.size();
  }
  return changed;
}

/// Each endpoint that it names in the list of parameters in which the claim is: these begin at whole words of the list.
bool RingClaims::all_have_rings(Bytes announcement, std::size_t claim) const {
  constexpr std::array<std::byte, 4> kGuidParameter[] = {
      {std::byte{0x5a}, std::byte{0}, std::byte{kGuid}, std::byte{0}},
      {std::byte{0}, std::byte{0x5a}, std::byte{0}, std::byte{kGuid}}};
  bool named = false;
  for (const auto& parameter : kGuidParameter) {
    for (std::size_t at = find(announcement, parameter); at + parameter.size() + kGuid <= announcement.size();
         at = find(announcement, parameter, at + 1)) {
      if (at % 4 != claim % 4) continue;
      named = true;
      const std::string file = folder_ + '/' + file_of(announcement.subspan(at + parameter.size(), kGuid));
      if (access(file.c_str(), F_OK) != 0) return false;
    }
  }
  return named;
}

}  // namespace rtd::bus
