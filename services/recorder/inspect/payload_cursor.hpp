// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/recorder/inspect/payload_layout.hpp"

namespace rtd::recording {

/// Bytes of one number of this kind; 4 for a text: its length.
std::size_t size_of(FieldKind kind);
/// A value as people read it.
std::string value_text(FieldKind kind, mcap::ByteView value);

/// Walks over a little-endian XCDR1 payload. Never reads past its end: from there on ok() is false.
class PayloadCursor {
 public:
  static constexpr std::size_t kHeaderBytes = 4;

  explicit PayloadCursor(mcap::ByteView payload);

  bool ok() const { return ok_; }
  /// The bytes of the next number, or of the next text without its end mark.
  mcap::ByteView take(FieldKind kind);
  /// Bytes to leave out before a number of `size` at `offset`.
  static std::size_t padding(std::size_t offset, std::size_t size) {
    return (size - (offset - kHeaderBytes) % size) % size;
  }

 private:
  mcap::ByteView bytes(std::size_t count);

  mcap::ByteView payload_;
  std::size_t position_ = kHeaderBytes;
  bool ok_ = true;
};

}  // namespace rtd::recording
