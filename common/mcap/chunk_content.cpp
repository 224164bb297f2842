// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/chunk_content.hpp"

#include <algorithm>

#include "common/io/bytes.hpp"
#include "common/mcap/codec.hpp"

namespace rtd::mcap {

std::string hex(std::uint32_t value) {
  std::string text = "0x00000000";
  for (std::size_t i = text.size(); i > 2; value /= 16) text[--i] = "0123456789abcdef"[value % 16];
  return text;
}

ChunkContent open_chunk(const Chunk& chunk, const ReaderOptions& options, Decompressor& decompress, Buffer& scratch) {
  const std::optional<Compression> compression = compression_of(chunk.compression);
  if (!compression)
    return {{}, ProblemKind::kUnknownCompression, "its compression \"" + chunk.compression + "\" is not known"};
  const std::uint64_t possible = largest_uncompressed_size(*compression, chunk.records.size());
  const std::uint64_t most = std::min(options.max_record_bytes, possible);
  if (chunk.uncompressed_size > most)
    return {{},
            ProblemKind::kTooLarge,
            "it claims " + std::to_string(chunk.uncompressed_size) + " bytes uncompressed; " +
                (most == possible ? "its " + std::to_string(chunk.records.size()) + " bytes cannot become more than "
                                  : std::string("the reader's limit is ")) +
                std::to_string(most)};
  ChunkContent content;
  content.records = decompress(*compression, chunk.records, chunk.uncompressed_size, scratch, content.what);
  if (!content.records) {
    content.fault = ProblemKind::kDamagedRecord;
  } else if (options.check_crcs && chunk.uncompressed_crc != 0) {
    const std::uint32_t found = io::crc32(*content.records);
    if (found == chunk.uncompressed_crc) return content;
    return {{},
            ProblemKind::kCrcMismatch,
            "the CRC of its content is " + hex(found) + ", it says " + hex(chunk.uncompressed_crc)};
  }
  return content;
}

std::optional<InnerRecord> RecordCursor::next() {
  if (cut_ || left() == 0) return std::nullopt;
  const ByteView rest = records_.subspan(position_);
  if (rest.size() < kFrameBytes || io::load<std::uint64_t>(rest.data() + 1) > rest.size() - kFrameBytes) {
    cut_ = true;
    return std::nullopt;
  }
  const auto length = io::load<std::uint64_t>(rest.data() + 1);
  const InnerRecord record{static_cast<Opcode>(rest[0]), position_, rest.subspan(kFrameBytes, length)};
  position_ += kFrameBytes + length;
  return record;
}

ChunkContent ChunkCache::get(const ChunkIndex& index) {
  if (const auto known = by_offset_.find(index.chunk_start_offset); known != by_offset_.end()) {
    entries_.splice(entries_.begin(), entries_, known->second);
    return {entries_.front().records, {}, {}};
  }
  make_room(index.uncompressed_size);
  entries_.emplace_front().offset = index.chunk_start_offset;
  ChunkContent content = load(index, entries_.front());
  if (content.records) {
    by_offset_[index.chunk_start_offset] = entries_.begin();
    held_bytes_ += content.records->size();
  } else {
    entries_.pop_front();
  }
  return content;
}

ChunkContent ChunkCache::load(const ChunkIndex& index, Entry& entry) {
  if (index.chunk_length < kFrameBytes || index.chunk_length > options_.max_record_bytes)
    return {{}, ProblemKind::kTooLarge, "its length is above the reader's limit"};
  const std::optional<ByteView> record = file_.view(index.chunk_start_offset, index.chunk_length);
  if (!record) return {{}, ProblemKind::kUnreadable, "the file cannot be read here"};
  const std::optional<Chunk> chunk = decode<Chunk>(record->subspan(kFrameBytes));
  if (!chunk) return {{}, ProblemKind::kDamagedRecord, "its fields do not fit"};
  ChunkContent content = open_chunk(*chunk, options_, decompress_, entry.buffer);
  if (!content.records) return content;
  if (chunk->compression.empty()) {
    // Still in the window, which moves on.
    const std::span<std::byte> copy = entry.buffer.reset(content.records->size());
    std::ranges::copy(*content.records, copy.begin());
    content.records = copy;
  }
  entry.records = *content.records;
  return content;
}

void ChunkCache::make_room(std::uint64_t bytes) {
  while (!entries_.empty() && held_bytes_ + bytes > options_.cache_bytes) {
    held_bytes_ -= entries_.back().records.size();
    by_offset_.erase(entries_.back().offset);
    entries_.pop_back();
  }
}

}  // namespace rtd::mcap
