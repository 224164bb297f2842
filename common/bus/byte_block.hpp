// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <span>

namespace rtd::bus {

/// Bytes of a changing number in memory that is kept and not cleared.
class ByteBlock {
 public:
  void assign(std::span<const std::byte> bytes) {
    if (bytes.size() > capacity_) {
      memory_.reset();
      memory_ = std::make_unique_for_overwrite<std::byte[]>(bytes.size());
      capacity_ = bytes.size();
    }
    size_ = bytes.size();
    if (!bytes.empty()) std::memcpy(memory_.get(), bytes.data(), bytes.size());
  }
  std::span<const std::byte> view() const { return {memory_.get(), size_}; }

 private:
  std::unique_ptr<std::byte[]> memory_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace rtd::bus
