// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/framing.hpp"

#include <algorithm>
#include <array>

#include "common/mcap/codec.hpp"
#include "common/mcap/compression.hpp"

namespace rtd::mcap {

std::optional<ByteView> SourceWindow::view(std::uint64_t offset, std::uint64_t length) {
  if (!has(offset, length)) return std::nullopt;
  const bool inside =
      offset >= start_ && offset - start_ <= bytes_.size() && length <= bytes_.size() - (offset - start_);
  if (!inside) {
    constexpr std::uint64_t kReadAhead = 1 << 16;
    const std::span<std::byte> into = buffer_.reset(std::min(length + kReadAhead, size() - offset));
    bytes_ = into.first(source_.read(offset, into));
    start_ = offset;
    if (bytes_.size() < length) return std::nullopt;
  }
  return bytes_.subspan(offset - start_, length);
}

bool SourceWindow::peek(std::uint64_t offset, std::span<std::byte> into) const {
  return has(offset, into.size()) && source_.read(offset, into) == into.size();
}

namespace {

struct RecordKind {
  const char* name;
  std::uint64_t least_length;  ///< of the content: all texts and maps empty
};

// By opcode, from 0x01 on.
constexpr std::array<RecordKind, 15> kKinds{{{"Header", 8},
                                             {"Footer", 20},
                                             {"Schema", 14},
                                             {"Channel", 16},
                                             {"Message", 22},
                                             {"Chunk", 40},
                                             {"MessageIndex", 6},
                                             {"ChunkIndex", 64},
                                             {"Attachment", 36},
                                             {"AttachmentIndex", 48},
                                             {"Statistics", 46},
                                             {"Metadata", 8},
                                             {"MetadataIndex", 20},
                                             {"SummaryOffset", 17},
                                             {"DataEnd", 4}}};

std::size_t number(Opcode opcode) {
  return static_cast<std::size_t>(opcode);
}

bool is_magic(const SourceWindow& file, std::uint64_t offset) {
  std::array<std::byte, kMagic.size()> bytes;
  return file.size() - offset == bytes.size() && file.peek(offset, bytes) &&
         std::ranges::equal(bytes, io::bytes_of(kMagic));
}

/// The lengths inside a chunk agree with that of the record.
bool is_consistent_chunk(const SourceWindow& file, const Frame& frame) {
  constexpr std::uint64_t kLongestName = 4;
  std::array<std::byte, 40 + kLongestName> head{};
  const auto read = static_cast<std::size_t>(std::min<std::uint64_t>(head.size(), frame.length));
  if (!file.peek(frame.content(), std::span(head).first(read))) return false;
  const auto name_length = io::load<std::uint32_t>(head.data() + 28);
  if (name_length > kLongestName || 40 + name_length > frame.length) return false;
  return io::load<std::uint64_t>(head.data() + 32 + name_length) == frame.length - 40 - name_length;
}

bool is_possible(const SourceWindow& file, const Frame& frame) {
  constexpr std::uint64_t kLongest = std::uint64_t{1} << 32;
  if (!is_known(frame.opcode) || frame.length > kLongest) return false;
  const std::uint64_t least = kKinds[number(frame.opcode) - 1].least_length;
  // A Footer never grows; a DataEnd may, but hardly by much.
  const std::uint64_t most =
      frame.opcode == Opcode::kFooter ? least : (frame.opcode == Opcode::kDataEnd ? 64 : kLongest);
  if (frame.length < least || frame.length > most) return false;
  const bool whole_chunk = frame.opcode == Opcode::kChunk && frame.fits(file.size());
  return !whole_chunk || is_consistent_chunk(file, frame);
}

bool stands_alone(std::byte opcode, bool loose_messages) {
  switch (static_cast<Opcode>(opcode)) {
    case Opcode::kChunk:
    case Opcode::kAttachment:
    case Opcode::kMetadata:
    case Opcode::kDataEnd:
    case Opcode::kFooter:
      return true;
    case Opcode::kSchema:
    case Opcode::kChannel:
    case Opcode::kMessage:
      return loose_messages;
    default:
      return false;
  }
}

}  // namespace

std::string name_of(Opcode opcode) {
  if (is_known(opcode)) return kKinds[number(opcode) - 1].name;
  constexpr const char* kDigits = "0123456789abcdef";
  return std::string("record of type 0x") + kDigits[number(opcode) / 16] + kDigits[number(opcode) % 16];
}

bool is_known(Opcode opcode) {
  return number(opcode) >= 1 && number(opcode) <= kKinds.size();
}

std::optional<Frame> frame_at(const SourceWindow& file, std::uint64_t offset) {
  std::array<std::byte, kFrameBytes> bytes;
  if (!file.peek(offset, bytes)) return std::nullopt;
  return Frame{static_cast<Opcode>(bytes[0]), offset, io::load<std::uint64_t>(bytes.data() + 1)};
}

bool begins_record(const SourceWindow& file, std::uint64_t offset) {
  for (int record = 0; record < 2; ++record) {
    if (offset == file.size() || is_magic(file, offset)) return true;
    const std::optional<Frame> frame = frame_at(file, offset);
    if (!frame) return record > 0;
    if (!is_possible(file, *frame)) return false;
    if (!frame->fits(file.size())) return record > 0;
    offset = frame->end();
  }
  return true;
}

std::optional<std::uint64_t> find_record(SourceWindow& file, std::uint64_t from, bool loose_messages) {
  constexpr std::uint64_t kBlock = 1 << 16;
  while (from < file.size() && file.size() - from >= kFrameBytes) {
    const std::optional<ByteView> block = file.view(from, std::min(kBlock, file.size() - from));
    if (!block) return std::nullopt;
    const std::size_t places = block->size() - kFrameBytes + 1;
    for (std::size_t i = 0; i < places; ++i) {
      if (!stands_alone((*block)[i], loose_messages)) continue;
      const bool fits = io::load<std::uint64_t>(block->data() + i + 1) <= file.size() - from - i - kFrameBytes;
      if (fits && begins_record(file, from + i)) return from + i;
    }
    from += places;
  }
  return std::nullopt;
}

}  // namespace rtd::mcap
