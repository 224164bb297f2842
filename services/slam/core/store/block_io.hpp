// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mcap/byte_sink.hpp"
#include "common/mcap/byte_source.hpp"
#include "services/slam/core/store/map_file_error.hpp"
#include "services/slam/core/store/map_format.hpp"

namespace rtd::slam::map_format {

/// Writes preamble and blocks of a map file, each with its CRC. Throws mcap::IoError.
class BlockWriter {
 public:
  explicit BlockWriter(mcap::ByteSink& sink);
  void write(BlockTag tag, mcap::ByteView payload);
  /// The last block; a file without it is cut.
  void end();

 private:
  mcap::ByteSink& sink_;
  std::uint32_t blocks_ = 0;
};

struct Block {
  BlockTag tag{};
  std::uint64_t offset = 0;  ///< in the file
  mcap::ByteView payload;    ///< valid until the next one is read
};

/// Reads them back, one block in memory at a time. Throws MapFileError for everything that is not as it was written.
class BlockReader {
 public:
  explicit BlockReader(const mcap::ByteSource& source);
  /// The next block, its checksum compared.
  Block next();
  /// `last` must be the end block, and nothing may follow.
  void check_end(const Block& last) const;
  std::uint64_t position() const { return position_; }
  std::uint64_t size() const { return source_.size(); }

 private:
  mcap::ByteView read(std::size_t size, const char* what);

  const mcap::ByteSource& source_;
  mcap::Bytes buffer_;
  std::uint64_t position_ = 0;
  std::uint32_t blocks_ = 0;
};

/// A damaged file, with the place.
[[noreturn]] void fail_damaged(std::uint64_t offset, const std::string& cause);

}  // namespace rtd::slam::map_format
