// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace rtd::bus {

/// Of an RTPS message. Places are octets of the body; they have to lie in it.
struct RtpsSubmessage {
  static constexpr int kHeartbeat = 0x07, kGap = 0x08, kInfoSource = 0x0c, kHeartbeatFrag = 0x13, kData = 0x15,
                       kDataFrag = 0x16;
  int kind = 0;
  unsigned flags = 0;
  std::span<const std::byte> body;

  std::uint16_t half(std::size_t at) const { return static_cast<std::uint16_t>(integer(at, 2)); }
  std::uint32_t word(std::size_t at) const { return static_cast<std::uint32_t>(integer(at, 4)); }
  std::uint64_t sequence_number(std::size_t at) const { return (integer(at, 4) << 32U) + integer(at + 4, 4); }

 private:
  std::uint64_t integer(std::size_t at, std::size_t octets) const;
};

/// Goes through the submessages of a message that is one by is_rtps_message(); of any other it reads no octet outside.
class RtpsSubmessages {
 public:
  explicit RtpsSubmessages(std::span<const std::byte> message);
  /// Empty behind the last one.
  std::optional<RtpsSubmessage> next();

 private:
  std::span<const std::byte> rest_;
};

}  // namespace rtd::bus
