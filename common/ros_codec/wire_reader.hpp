// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/ros_codec/byte_cursor.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::ros {

/// Reads messages by their lists of fields. What it allocates is bounded by the bytes that it is given, whatever they
/// claim. Throws WireError.
template <Wire kFormat>
class WireReader {
 public:
  explicit WireReader(Bytes bytes) : cursor_(kFormat == Wire::kCdr ? body(bytes) : bytes) {}

  template <class Message>
  void operator()(Message& message) {
    read(message);
  }

 private:
  static Bytes body(Bytes bytes) {
    constexpr std::size_t kHeaderBytes = 4;
    ByteCursor cursor(bytes);
    const Bytes header = cursor.take(kHeaderBytes);
    if (header[0] != 0 || header[1] != 1) {
      throw WireError("encapsulation " + std::to_string(header[0]) + " " + std::to_string(header[1]) +
                      " is not plain little-endian CDR (0 1)");
    }
    return bytes.subspan(kHeaderBytes);
  }

  void align(std::size_t size) {
    if constexpr (kFormat == Wire::kCdr) cursor_.take((size - cursor_.position() % size) % size);
  }

  template <class T>
  void read(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = cursor_.read<std::uint8_t>() != 0;
    } else if constexpr (std::is_enum_v<T>) {
      std::underlying_type_t<T> number{};
      read(number);
      value = static_cast<T>(number);
    } else if constexpr (std::is_arithmetic_v<T>) {
      align(sizeof(T));
      value = cursor_.read<T>();
    } else if constexpr (UnalignedNumber<T>) {
      typename T::Number number{};
      read(number);
      value = number;
    } else {
      for_each_part<kFormat>(value, [this](auto& part) { read(part); });
    }
  }

  std::size_t read_count() {
    std::uint32_t count = 0;
    read(count);
    return count;
  }

  void read(std::string& text) {
    const std::size_t length = read_count();
    Bytes bytes = cursor_.take(length);
    if (kFormat == Wire::kCdr && length > 0) {  // some programs write an empty string as length 0, without end mark
      if (bytes.back() != 0) {
        throw WireError("a string of " + std::to_string(length) + " bytes before byte " +
                        std::to_string(cursor_.position()) + " has no end mark");
      }
      bytes = bytes.first(length - 1);
    }
    text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  template <class T, std::size_t kSize>
  void read(std::array<T, kSize>& values) {
    if constexpr (std::is_arithmetic_v<T>) {
      align(sizeof(T));
      std::memcpy(values.data(), cursor_.take(sizeof(values)).data(), sizeof(values));
    } else {
      for (T& value : values) read(value);
    }
  }

  template <class T>
  void read(std::vector<T>& values) {
    const std::size_t count = read_count();
    if constexpr (sizeof(T) == 1) {
      const Bytes bytes = cursor_.take(count);
      values.assign(bytes.begin(), bytes.end());
    } else if constexpr (std::is_arithmetic_v<T>) {
      if (count > 0) align(sizeof(T));
      const Bytes bytes = cursor_.take(count * sizeof(T));
      values.resize(count);
      if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
    } else {
      values.clear();
      for (std::size_t i = 0; i < count; ++i) read(values.emplace_back());  // a wrong count ends in a WireError
    }
  }

  ByteCursor cursor_;
};

/// The message that the bytes hold; bytes behind it are ignored, as DDS pads. Throws WireError.
template <class Message>
Message decode(Wire wire, Bytes bytes) {
  Message message;
  if (wire == Wire::kRos1) {
    WireReader<Wire::kRos1>{bytes}(message);
  } else {
    WireReader<Wire::kCdr>{bytes}(message);
  }
  return message;
}

}  // namespace rtd::ros
