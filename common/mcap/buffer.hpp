// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/mcap/records.hpp"

namespace rtd::mcap {

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

}  // namespace rtd::mcap
