// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/chunk_cache.hpp"

#include <algorithm>
#include <numeric>

#include "common/mcap/decode.hpp"
#include "common/mcap/encode.hpp"

namespace rtd::mcap {

ChunkContent ChunkCache::get(const ChunkIndex& index) {
  const auto known = std::ranges::find(entries_, index.chunk_start_offset, &Entry::offset);
  if (known != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, known);
    return {entries_.front().records, {}, {}};
  }
  make_room(index.uncompressed_size);
  entries_.emplace_front().offset = index.chunk_start_offset;
  ChunkContent content = load(index, entries_.front());
  if (!content.records) entries_.pop_front();
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
  const auto held = [&] {
    return std::accumulate(entries_.begin(), entries_.end(), bytes,
                           [](std::uint64_t sum, const Entry& entry) { return sum + entry.records.size(); });
  };
  while (!entries_.empty() && held() > options_.cache_bytes) entries_.pop_back();
}

}  // namespace rtd::mcap
