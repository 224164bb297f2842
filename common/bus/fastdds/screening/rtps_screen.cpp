// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/rtps_screen.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

#include "common/msg/largest_sample.hpp"

namespace rtd::bus {
namespace {

constexpr std::size_t kMessageHeader = 20;

/// Offsets are bytes of the body; they have to lie in it.
struct Submessage {
  enum Kind : std::uint8_t {
    kPad = 0x01,
    kHeartbeat = 0x07,
    kGap = 0x08,
    kInfoTimestamp = 0x09,
    kInfoSource = 0x0c,
    kHeartbeatFrag = 0x13,
    kData = 0x15,
    kDataFrag = 0x16,
    kFirstOfVendors = 0x80
  };
  std::uint8_t kind = 0, flags = 0;
  std::span<const std::byte> body;

  std::uint16_t half(std::size_t at) const { return static_cast<std::uint16_t>(integer(at, 2)); }
  std::uint32_t word(std::size_t at) const { return static_cast<std::uint32_t>(integer(at, 4)); }
  std::uint64_t sequence_number(std::size_t at) const { return (integer(at, 4) << 32U) + integer(at + 4, 4); }

 private:
  std::uint64_t integer(std::size_t at, std::size_t bytes) const {
    const bool little_endian = (flags & 1U) != 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i)
      value = 256 * value + std::to_integer<std::uint64_t>(body[at + (little_endian ? bytes - 1 - i : i)]);
    return value;
  }
};

/// RTPS 2.x, with those of DDS-Security.
bool is_known(std::uint8_t kind) {
  constexpr std::uint8_t kKnown[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e, 0x0f,
                                     0x12, 0x13, 0x15, 0x16, 0x30, 0x31, 0x32, 0x33, 0x34};
  return std::find(std::begin(kKnown), std::end(kKnown), kind) != std::end(kKnown);
}

/// Takes the next submessage off `rest`; empty when it breaks the frame.
std::optional<Submessage> take(std::span<const std::byte>& rest) {
  constexpr std::size_t kHeader = 4;
  if (rest.size() < kHeader) return std::nullopt;
  Submessage found{std::to_integer<std::uint8_t>(rest[0]), std::to_integer<std::uint8_t>(rest[1]), rest};
  std::size_t length = found.half(2);
  const std::size_t room = rest.size() - kHeader;
  if (length > room) return std::nullopt;
  const bool of_vendor = found.kind >= Submessage::kFirstOfVendors;
  if (!of_vendor && !is_known(found.kind)) return std::nullopt;
  if (length == 0 && !of_vendor && found.kind != Submessage::kPad && found.kind != Submessage::kInfoTimestamp)
    length = room;  // the rest is its content
  const bool last = length == room;
  // The vendors that we know send a submessage of their own only at the end.
  if (!last && (of_vendor || length % 4 != 0)) return std::nullopt;
  found.body = rest.subspan(kHeader, length);
  rest = rest.subspan(kHeader + length);
  return found;
}

/// Where the list of parameters at `at` ends; 0: nowhere in the submessage.
std::size_t behind_parameters(const Submessage& submessage, std::size_t at) {
  constexpr std::uint16_t kSentinel = 1;
  while (at + 4 <= submessage.body.size()) {
    const std::uint16_t parameter = submessage.half(at), length = submessage.half(at + 2);
    at += 4;
    if (parameter == kSentinel) return at;
    at += length;
  }
  return 0;
}

/// Endpoints of applications give up what is too large themselves; those of the vendor do not.
bool may_be_kept(std::byte writer_kind, std::uint64_t first_fragment, std::uint64_t sample) {
  constexpr std::byte kBuiltin{0xc0};
  if ((writer_kind & kBuiltin) == kBuiltin) return sample <= kLargestBuiltinSample;
  return first_fragment == 1 || sample <= msg::kLargestOfOthers;
}

constexpr std::size_t kSubmessageHeader = 4;
constexpr std::size_t kFirstFragment = 20, kSampleSize = SampleFragments::kSizeBehind - kSubmessageHeader;  // DATA_FRAG

bool has_whole_fragments(const Submessage& data_frag) {
  constexpr std::size_t kOffsetToQos = 2, kBehindOffset = 4, kWriterKind = 11, kFragments = 24, kFragmentSize = 26,
                        kHeader = 32;
  constexpr unsigned kHasQos = 2;
  if (data_frag.body.size() < kHeader) return false;
  const std::uint64_t first = data_frag.word(kFirstFragment), count = data_frag.half(kFragments),
                      size = data_frag.half(kFragmentSize), sample = data_frag.word(kSampleSize);
  if (first == 0 || count == 0 || size == 0 || sample == 0) return false;
  if (!may_be_kept(data_frag.body[kWriterKind], first, sample)) return false;
  const std::uint64_t begin = (first - 1) * size, end = std::min((first + count - 1) * size, sample);
  if (begin >= sample || (first + count - 2) * size >= sample) return false;
  std::size_t payload = std::max(kHeader, kBehindOffset + data_frag.half(kOffsetToQos));
  if ((data_frag.flags & kHasQos) != 0) payload = behind_parameters(data_frag, payload);
  return payload >= kHeader && payload <= data_frag.body.size() && data_frag.body.size() - payload >= end - begin;
}

/// Where a kind of submessage names its writer and how many numbers stand behind.
struct Layout {
  std::size_t writer = 0, numbers = 0;
};

Layout layout_of(std::uint8_t kind) {
  using S = Submessage;
  if (kind == S::kData || kind == S::kDataFrag) return {8, 1};  // behind flags, offset to the QoS and reader
  if (kind == S::kHeartbeat || kind == S::kGap) return {4, 2};
  return kind == S::kHeartbeatFrag ? Layout{4, 1} : Layout{};
}

/// Collects the largest number of each writer. The first 12 bytes of a GUID are those of the participant that the
/// message, or what follows an INFO_SOURCE, is from.
class NumberReader {
 public:
  NumberReader(std::span<const std::byte> prefix, std::vector<WriterNumber>& largest) : largest_(largest) {
    set_source(prefix);
  }

  /// Of the last submessage that names one.
  const WriterGuid& source() const { return source_; }

  void read(const Submessage& submessage) {
    constexpr std::size_t kPrefixInInfoSource = 8, kNumber = 8;
    const auto body = submessage.body;
    if (submessage.kind == Submessage::kInfoSource && body.size() >= kPrefixInInfoSource + kPrefix)
      return set_source(body.subspan(kPrefixInInfoSource));
    const Layout layout = layout_of(submessage.kind);
    const std::size_t first = layout.writer + kEntity;
    if (layout.numbers == 0 || body.size() < first + kNumber * layout.numbers) return;
    std::copy_n(body.begin() + static_cast<std::ptrdiff_t>(layout.writer), kEntity, source_.begin() + kPrefix);
    for (std::size_t at = first; at < first + kNumber * layout.numbers; at += kNumber)
      add(submessage.sequence_number(at));
  }

 private:
  static constexpr std::size_t kPrefix = 12, kEntity = 4;

  void set_source(std::span<const std::byte> prefix) { std::copy_n(prefix.begin(), kPrefix, source_.begin()); }
  void add(std::uint64_t number) {
    const auto known =
        std::find_if(largest_.begin(), largest_.end(), [this](const auto& other) { return other.writer == source_; });
    if (known == largest_.end()) return largest_.push_back({source_, number});
    known->number = std::max(known->number, number);
  }

  WriterGuid source_{};
  std::vector<WriterNumber>& largest_;
};

}  // namespace

std::span<const std::byte> without_last(std::span<const std::byte> message, std::size_t bytes) {
  if (message.size() <= kMessageHeader + bytes) return message;
  std::span<const std::byte> rest = message.subspan(kMessageHeader);
  while (rest.size() > bytes)
    if (!take(rest)) return message;
  return rest.size() == bytes ? message.first(message.size() - bytes) : message;
}

RtpsMessage read_rtps_message(std::span<const std::byte> datagram) {
  constexpr std::size_t kPrefixInHeader = 8;
  RtpsMessage message;
  if (datagram.size() < kMessageHeader || std::memcmp(datagram.data(), "RTPS\2", 5) != 0) return message;
  NumberReader numbers(datagram.subspan(kPrefixInHeader), message.numbers);
  for (auto rest = datagram.subspan(kMessageHeader); !rest.empty();) {
    const std::optional<Submessage> submessage = take(rest);
    if (!submessage) return message;
    numbers.read(*submessage);
    if (submessage->kind != Submessage::kDataFrag) continue;
    if (has_whole_fragments(*submessage)) {
      const auto body_at = static_cast<std::size_t>(submessage->body.data() - datagram.data());
      message.fragments.push_back({numbers.source(), submessage->word(kFirstFragment), submessage->word(kSampleSize),
                                   body_at - kSubmessageHeader});
    } else {
      message.whole_fragments = false;
    }
  }
  message.well_formed = true;
  return message;
}

bool NumberGuard::plausible(const WriterGuid& writer, std::uint64_t number) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max() - kFar;
  if (number > kLargest) return false;
  if (known_.size() >= kWriters && !known_.contains(writer))
    known_.clear();  // unknown participants must not fill the memory
  Known& known = known_[writer];
  if (number <= known.highest + kFar) {
    known.highest = std::max(known.highest, number);
    known.in_a_row = 0;
    return true;
  }
  const bool again = number <= known.doubtful + kFar && known.doubtful <= number + kFar;
  known.in_a_row = again ? known.in_a_row + 1 : 1;
  known.doubtful = number;
  if (known.in_a_row < kMessages) return false;
  known.highest = number;
  known.in_a_row = 0;
  return true;
}

bool RtpsScreen::passes(std::span<const std::byte> datagram) {
  const RtpsMessage message = read_rtps_message(datagram);
  if (!message.well_formed || !message.whole_fragments) return false;
  return std::all_of(message.numbers.begin(), message.numbers.end(),
                     [this](const WriterNumber& named) { return guard_.plausible(named.writer, named.number); });
}

}  // namespace rtd::bus
