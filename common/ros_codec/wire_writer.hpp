// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "common/ros_codec/wire.hpp"

namespace rtd::ros {

/// Writes messages of wire.hpp.
template <Wire kFormat>
class WireWriter {
 public:
  static constexpr Wire kWire = kFormat;

  WireWriter() {
    if constexpr (kFormat == Wire::kCdr) bytes_ = {0, 1, 0, 0};
  }

  template <class... Fields>
  void operator()(const Fields&... values) {
    (write(values), ...);
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  void align(std::size_t size) {
    constexpr std::size_t kHeaderBytes = 4;
    if constexpr (kFormat == Wire::kCdr) {
      const std::size_t position = bytes_.size() - kHeaderBytes;
      bytes_.resize(bytes_.size() + (size - position % size) % size);
    }
  }

  void append(const void* source, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(source);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  template <class T>
  void write(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      bytes_.push_back(value ? 1 : 0);
    } else if constexpr (std::is_arithmetic_v<T>) {
      align(sizeof(T));
      append(&value, sizeof(T));
    } else {
      fields(*this, value);
    }
  }

  void write(const std::string& text) {
    write(static_cast<std::uint32_t>(text.size() + (kFormat == Wire::kCdr ? 1 : 0)));
    append(text.data(), text.size());
    if constexpr (kFormat == Wire::kCdr) bytes_.push_back(0);
  }

  template <class T, std::size_t kSize>
  void write(const std::array<T, kSize>& values) {
    for (const T& value : values) write(value);
  }

  template <class T>
  void write(const std::vector<T>& values) {
    write(static_cast<std::uint32_t>(values.size()));
    if constexpr (std::is_arithmetic_v<T>) {
      if (!values.empty()) align(sizeof(T));
      append(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) write(value);
    }
  }

  std::vector<std::uint8_t> bytes_;
};

template <Wire kFormat, class Message>
std::vector<std::uint8_t> encode(const Message& message) {
  WireWriter<kFormat> writer;
  writer(message);
  return writer.take();
}

}  // namespace rtd::ros
