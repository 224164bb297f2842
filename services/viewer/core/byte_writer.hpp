// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>

#include "services/viewer/core/outbox.hpp"

namespace rtd::viewer {

static_assert(std::endian::native == std::endian::little, "binary messages are little-endian");

/// Appends values as they stand in binary messages: little-endian, packed.
class ByteWriter {
 public:
  template <class... T>
  explicit ByteWriter(T... values) {
    (put(values), ...);
  }
  template <class T>
  void put(T value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t end = bytes_.size();
    bytes_.resize(end + sizeof(T));
    std::memcpy(bytes_.data() + end, &value, sizeof(T));
  }
  void put_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), bytes, bytes + size);
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    put_bytes(text.data(), text.size());
  }
  /// Overwrites a value that stands at `position`.
  template <class T>
  void set(std::size_t position, T value) {
    std::memcpy(bytes_.data() + position, &value, sizeof(T));
  }
  void reserve(std::size_t size) { bytes_.reserve(size); }
  std::size_t size() const { return bytes_.size(); }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

}  // namespace rtd::viewer
