// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/rtps_numbers.hpp"

#include <algorithm>

namespace rtd::bus {
namespace {

constexpr std::size_t kMessageHeader = 20, kSubmessageHeader = 4, kPrefix = 12, kEntity = 4, kNumber = 8;
constexpr int kHeartbeat = 0x07, kGap = 0x08, kInfoSource = 0x0c, kHeartbeatFrag = 0x13, kData = 0x15, kDataFrag = 0x16;
constexpr std::size_t kPrefixInHeader = 8, kPrefixInInfoSource = 8;

using Octets = std::span<const std::byte>;

std::uint64_t word(Octets bytes, std::size_t at, bool little_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = 256 * value + std::to_integer<std::uint64_t>(bytes[at + (little_endian ? 3 - i : i)]);
  return value;
}

/// Where a kind of submessage names its writer and, behind it, its numbers.
struct Layout {
  std::size_t writer = 0, numbers = 0;
};

Layout layout_of(int kind) {
  if (kind == kData || kind == kDataFrag) return {8, 1};  // behind flags, offset to the QoS and reader
  if (kind == kHeartbeat || kind == kGap) return {4, 2};
  return kind == kHeartbeatFrag ? Layout{4, 1} : Layout{};
}

class Numbers {
 public:
  explicit Numbers(Octets prefix) { from(prefix); }

  void from(Octets prefix) { std::copy_n(prefix.begin(), kPrefix, source_.begin()); }
  void add(Octets entity, std::uint64_t number) {
    std::copy_n(entity.begin(), kEntity, source_.begin() + kPrefix);
    const auto known =
        std::find_if(largest_.begin(), largest_.end(), [this](const auto& other) { return other.writer == source_; });
    if (known == largest_.end()) return largest_.push_back({source_, number});
    known->number = std::max(known->number, number);
  }
  std::vector<WriterNumber> take() { return std::move(largest_); }

 private:
  WriterGuid source_{};
  std::vector<WriterNumber> largest_;
};

void read(int kind, Octets body, bool little_endian, Numbers& numbers) {
  if (kind == kInfoSource && body.size() >= kPrefixInInfoSource + kPrefix)
    return numbers.from(body.subspan(kPrefixInInfoSource));
  const Layout layout = layout_of(kind);
  const std::size_t first = layout.writer + kEntity;
  if (layout.numbers == 0 || body.size() < first + kNumber * layout.numbers) return;
  for (std::size_t at = first; at < first + kNumber * layout.numbers; at += kNumber)
    numbers.add(body.subspan(layout.writer, kEntity),
                (word(body, at, little_endian) << 32U) + word(body, at + 4, little_endian));
}

}  // namespace

std::vector<WriterNumber> sequence_numbers_of(Octets message) {
  Numbers numbers(message.subspan(kPrefixInHeader, kPrefix));
  std::size_t at = kMessageHeader;
  while (at + kSubmessageHeader <= message.size()) {
    const int kind = std::to_integer<int>(message[at]);
    const bool little_endian = (std::to_integer<unsigned>(message[at + 1]) & 1U) != 0;
    const auto first = std::to_integer<std::size_t>(message[at + 2]),
               second = std::to_integer<std::size_t>(message[at + 3]);
    const std::size_t length = little_endian ? first + 256 * second : 256 * first + second;
    at += kSubmessageHeader;
    const bool to_the_end = length == 0 && layout_of(kind).numbers > 0;
    const std::size_t size = to_the_end ? message.size() - at : std::min(length, message.size() - at);
    read(kind, message.subspan(at, size), little_endian, numbers);
    at += size;
  }
  return numbers.take();
}

}  // namespace rtd::bus
