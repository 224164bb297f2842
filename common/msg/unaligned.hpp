// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace rtd::msg {

/// A number of 8 bytes that may lie on any multiple of 4, as in the shared memory of Fast DDS, whose samples begin 4
/// bytes behind a multiple of 8. Converts from and to the number; costs nothing.
template <class T>
class Unaligned {
 public:
  static_assert(std::is_arithmetic_v<T> && sizeof(T) == 8);
  using Number = T;

  Unaligned() = default;                                             ///< not initialised, like a plain number
  Unaligned(T value) { std::memcpy(bytes_, &value, sizeof value); }  // NOLINT(google-explicit-constructor)
  operator T() const { return value(); }                             // NOLINT(google-explicit-constructor)
  T value() const {
    T value;
    std::memcpy(&value, bytes_, sizeof value);
    return value;
  }

 private:
  alignas(4) std::byte bytes_[sizeof(T)];
};

template <std::size_t kSize, class T>
std::array<T, kSize> aligned(const std::array<Unaligned<T>, kSize>& numbers) {
  std::array<T, kSize> copy;
  std::copy(numbers.begin(), numbers.end(), copy.begin());
  return copy;
}

template <std::size_t kSize, class T>
std::array<Unaligned<T>, kSize> unaligned(const std::array<T, kSize>& numbers) {
  std::array<Unaligned<T>, kSize> copy;
  std::copy(numbers.begin(), numbers.end(), copy.begin());
  return copy;
}

}  // namespace rtd::msg
