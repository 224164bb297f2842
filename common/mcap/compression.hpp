// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/mcap/records.hpp"

namespace rtd::mcap {

enum class Compression { kNone, kLz4, kZstd };

/// "", "lz4" or "zstd", as a Chunk names it.
std::string name_of(Compression compression);
std::optional<Compression> compression_of(const std::string& name);

/// `data` as one LZ4 frame or one zstd frame, in `out`, at the library's usual level.
/// kNone returns `data` itself. Throws std::runtime_error with the library's message.
ByteView compress(Compression compression, ByteView data, Buffer& out);

/// Most bytes that `compressed_size` bytes can become, from how the formats code a run: a larger claim is false.
std::uint64_t largest_uncompressed_size(Compression compression, std::uint64_t compressed_size);

/// Keeps the libraries' working memory from one chunk to the next. For one thread.
class Decompressor {
 public:
  Decompressor();
  ~Decompressor();
  Decompressor(Decompressor&&) noexcept;

  /// The `size` bytes that `data` decompresses to, in `out` (kNone: `data` itself); empty with `reason` set when it is
  /// damaged or becomes another size. The caller has checked `size`: it is allocated.
  std::optional<ByteView> operator()(Compression compression, ByteView data, std::uint64_t size, Buffer& out,
                                     std::string& reason);

 private:
  struct Contexts;
  std::unique_ptr<Contexts> contexts_;
};

}  // namespace rtd::mcap
