// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>

#include "common/mcap/chunk_content.hpp"
#include "common/mcap/source_window.hpp"

namespace rtd::mcap {

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
};

}  // namespace rtd::mcap
