// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace rtd::io {

/// What the parts of a recording may become unpacked, all together. A part alone can become 32000 times as large (zstd)
/// and there can be many; recordings of cameras become ten times as large.
class UnpackLimit {
 public:
  explicit UnpackLimit(std::uint64_t file_bytes) : left_(kFree + kPerByte * std::min(file_bytes, UINT64_MAX / 128)) {}

  /// False: that is too much.
  bool take(std::uint64_t bytes) {
    if (bytes > left_) return false;
    left_ -= bytes;
    return true;
  }

 private:
  static constexpr std::uint64_t kFree = 32 << 20, kPerByte = 64;
  std::uint64_t left_;
};

}  // namespace rtd::io
