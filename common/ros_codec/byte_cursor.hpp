// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace rtd::ros {

static_assert(std::endian::native == std::endian::little, "the wire formats here are little endian");

using Bytes = std::span<const std::uint8_t>;

/// Bytes that do not hold what they claim; what() says where and how much is missing.
class WireError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads bytes of unknown origin in order. Checks every step against what is left.
class ByteCursor {
 public:
  explicit ByteCursor(Bytes bytes) : bytes_(bytes) {}

  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }

  /// The next `count` bytes. Throws WireError when fewer are left.
  Bytes take(std::size_t count) {
    if (count > remaining()) {
      throw WireError(std::to_string(count) + " bytes are claimed at byte " + std::to_string(position_) + ", " +
                      std::to_string(remaining()) + " are left");
    }
    position_ += count;
    return bytes_.subspan(position_ - count, count);
  }

  /// The next little-endian number.
  template <class T>
  requires std::is_arithmetic_v<T> T read() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }

 private:
  Bytes bytes_;
  std::size_t position_ = 0;
};

inline std::string to_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace rtd::ros
