// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/rtps_numbers.hpp"

#include <algorithm>

#include "common/bus/fastdds/screening/rtps_submessage.hpp"

namespace rtd::bus {
namespace {

constexpr std::size_t kPrefix = 12, kEntity = 4, kNumber = 8;
constexpr std::size_t kPrefixInHeader = 8, kPrefixInInfoSource = 8;

/// Where a kind of submessage names its writer and how many numbers stand behind.
struct Layout {
  std::size_t writer = 0, numbers = 0;
};

Layout layout_of(int kind) {
  using S = RtpsSubmessage;
  if (kind == S::kData || kind == S::kDataFrag) return {8, 1};  // behind flags, offset to the QoS and reader
  if (kind == S::kHeartbeat || kind == S::kGap) return {4, 2};
  return kind == S::kHeartbeatFrag ? Layout{4, 1} : Layout{};
}

class Numbers {
 public:
  explicit Numbers(std::span<const std::byte> prefix) { from(prefix); }

  void from(std::span<const std::byte> prefix) { std::copy_n(prefix.begin(), kPrefix, source_.begin()); }
  void add(std::span<const std::byte> entity, std::uint64_t number) {
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

void read(const RtpsSubmessage& submessage, Numbers& numbers) {
  const auto body = submessage.body;
  if (submessage.kind == RtpsSubmessage::kInfoSource && body.size() >= kPrefixInInfoSource + kPrefix)
    return numbers.from(body.subspan(kPrefixInInfoSource));
  const Layout layout = layout_of(submessage.kind);
  const std::size_t first = layout.writer + kEntity;
  if (layout.numbers == 0 || body.size() < first + kNumber * layout.numbers) return;
  for (std::size_t at = first; at < first + kNumber * layout.numbers; at += kNumber)
    numbers.add(body.subspan(layout.writer, kEntity), submessage.sequence_number(at));
}

}  // namespace

std::vector<WriterNumber> sequence_numbers_of(std::span<const std::byte> message) {
  Numbers numbers(message.subspan(kPrefixInHeader, kPrefix));
  RtpsSubmessages submessages(message);
  while (const auto submessage = submessages.next()) read(*submessage, numbers);
  return numbers.take();
}

}  // namespace rtd::bus
