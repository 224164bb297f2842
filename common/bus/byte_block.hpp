// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <span>

namespace rtd::bus {

/// Bytes of a changing number in memory that is kept and not cleared. Made for samples as CDR: what follows the 4 bytes
/// of their header is aligned to 16, and the last bytes may be read in groups of 4.
class ByteBlock {
 public:
  static constexpr std::size_t kCdrHeaderBytes = 4;

  /// The bytes are undefined afterwards.
  void resize(std::size_t size) {
    if (size > capacity_) {
      memory_.reset();
      memory_ = std::make_unique_for_overwrite<std::byte[]>(kLead + size + kPadding);
      capacity_ = size;
    }
    size_ = size;
    if (memory_) std::memset(bytes().data() + size, 0, kPadding);
  }
  void assign(std::span<const std::byte> bytes_to_keep) {
    resize(bytes_to_keep.size());
    if (!bytes_to_keep.empty()) std::memcpy(bytes().data(), bytes_to_keep.data(), bytes_to_keep.size());
  }
  std::span<std::byte> bytes() { return memory_ ? std::span(memory_.get() + kLead, size_) : std::span<std::byte>(); }
  std::span<const std::byte> view() const { return const_cast<ByteBlock*>(this)->bytes(); }

 private:
  static constexpr std::size_t kLead = 16 - kCdrHeaderBytes, kPadding = 3;

  std::unique_ptr<std::byte[]> memory_;
  std::size_t size_ = 0, capacity_ = 0;
};

static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= 16, "ByteBlock aligns by what new gives");

}  // namespace rtd::bus
