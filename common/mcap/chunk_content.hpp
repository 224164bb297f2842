// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <map>
#include <optional>

#include "common/mcap/compression.hpp"
#include "common/mcap/framing.hpp"
#include "common/mcap/problem.hpp"

namespace rtd::mcap {

/// What bounds a reader, whatever a file claims.
struct ReaderOptions {
  std::uint64_t max_record_bytes = 1 << 29;  ///< of a record, and of a chunk when uncompressed
  std::uint64_t cache_bytes = 1 << 27;       ///< of uncompressed chunks that an IndexedReader keeps
  std::size_t max_problems = 1000;           ///< listed; more are counted
  bool check_crcs = true;
  /// Delivers the whole records of an uncompressed chunk that the end of the file cuts. No CRC covers them.
  bool salvage_cut_chunk = false;
};

/// The uncompressed records of a chunk, or why there are none.
struct ChunkContent {
  std::optional<ByteView> records;  ///< in the scratch buffer or in the chunk itself
  ProblemKind fault{};
  std::string what;
};
ChunkContent open_chunk(const Chunk& chunk, const ReaderOptions& options, Decompressor& decompress, Buffer& scratch);

/// "0x" and eight digits.
std::string hex(std::uint32_t value);

/// One record inside a chunk or summary.
struct InnerRecord {
  Opcode opcode{};
  std::uint64_t offset = 0;  ///< in the uncompressed chunk or summary
  ByteView content;
};

/// Goes through records in memory: an uncompressed chunk, a summary.
class RecordCursor {
 public:
  RecordCursor() = default;
  explicit RecordCursor(ByteView records) : records_(records) {}

  /// Empty at the end, and where a record is longer than what is left: then cut() is true.
  std::optional<InnerRecord> next();
  bool cut() const { return cut_; }
  std::uint64_t position() const { return position_; }
  std::uint64_t left() const { return records_.size() - position_; }

 private:
  ByteView records_;
  std::uint64_t position_ = 0;
  bool cut_ = false;
};

/// Uncompressed chunks, the last used ones, at most `cache_bytes` (but at least one).
class ChunkCache {
 public:
  ChunkCache(SourceWindow& file, const ReaderOptions& options) : file_(file), options_(options) {}

  /// The records of the chunk, until the next call; where there are none, the reason.
  ChunkContent get(const ChunkIndex& index);

 private:
  struct Entry {
    std::uint64_t offset = 0;
    Buffer buffer;
    ByteView records;
  };
  ChunkContent load(const ChunkIndex& index, Entry& entry);
  void make_room(std::uint64_t bytes);

  SourceWindow& file_;
  const ReaderOptions& options_;
  Decompressor decompress_;
  std::list<Entry> entries_;  ///< last used first
  std::map<std::uint64_t, std::list<Entry>::iterator> by_offset_;
  std::uint64_t held_bytes_ = 0;
};

}  // namespace rtd::mcap
