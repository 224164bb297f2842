// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/mcap/buffer.hpp"
#include "common/mcap/byte_source.hpp"

namespace rtd::mcap {

/// The part of a source that a reader has in memory: views inside it cost no read.
class SourceWindow {
 public:
  explicit SourceWindow(const ByteSource& source) : source_(source) {}

  std::uint64_t size() const { return source_.size(); }
  /// The bytes [offset, offset + length), until the next view(); empty when the source does not have or give them.
  /// Allocates `length` bytes at most (64 KiB at least): the caller bounds it.
  std::optional<ByteView> view(std::uint64_t offset, std::uint64_t length);
  /// Copies bytes without moving the window; false when the source does not have or give them.
  bool peek(std::uint64_t offset, std::span<std::byte> into) const;

 private:
  bool has(std::uint64_t offset, std::uint64_t length) const { return offset <= size() && length <= size() - offset; }

  const ByteSource& source_;
  Buffer buffer_;
  std::uint64_t start_ = 0;
  ByteView bytes_;
};

}  // namespace rtd::mcap
