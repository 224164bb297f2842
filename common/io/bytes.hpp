// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace rtd::io {

using ByteView = std::span<const std::byte>;
using Bytes = std::vector<std::byte>;

/// Reused memory whose bytes are not set before they are written: std::vector would clear megabytes for nothing.
class Buffer {
 public:
  /// `size` bytes of any content; what was there before is gone.
  std::span<std::byte> reset(std::size_t size) {
    if (size > capacity_) {
      bytes_.reset();  // first, so that not both are held
      bytes_ = std::make_unique_for_overwrite<std::byte[]>(size);
      capacity_ = size;
    }
    return {bytes_.get(), size};
  }

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t capacity_ = 0;
};

inline ByteView bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// Little-endian integer at `bytes`, which must hold sizeof(T).
template <std::unsigned_integral T>
T load(const std::byte* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value |= static_cast<T>(std::to_integer<T>(bytes[i]) << (8 * i));
  return value;
}

/// Writes an integer, little-endian, to `at`, which must have room for it.
void store(std::byte* at, std::unsigned_integral auto value) {
  for (std::size_t i = 0; i < sizeof(value); ++i) at[i] = static_cast<std::byte>(value >> (8 * i));
}

/// CRC-32 (IEEE 802.3, as zlib computes it) of what `crc` is the CRC of (0: nothing) followed by `data`.
std::uint32_t crc32(ByteView data, std::uint32_t crc = 0);

/// CRC of two byte strings in a row from their CRCs and the size of the second, without reading either again.
std::uint32_t crc32_combine(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

}  // namespace rtd::io
