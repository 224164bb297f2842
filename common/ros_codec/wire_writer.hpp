// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/ros_codec/wire.hpp"

namespace rtd::ros {

/// Where written bytes go.
class ByteVector {
 public:
  void append(const void* source, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(source);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  void pad(std::size_t size) { bytes_.resize(bytes_.size() + size); }
  std::size_t size() const { return bytes_.size(); }
  void reserve(std::size_t size) { bytes_.reserve(size); }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Writes into memory that is there already.
class ByteSpan {
 public:
  explicit ByteSpan(std::span<std::uint8_t> memory) : memory_(memory) {}
  void append(const void* source, std::size_t size) {
    if (size <= room() && size > 0) std::memcpy(memory_.data() + size_, source, size);
    size_ += size;
  }
  void pad(std::size_t size) {
    if (size <= room() && size > 0) std::memset(memory_.data() + size_, 0, size);
    size_ += size;
  }
  /// What has been written, larger than the memory when it did not fit.
  std::size_t size() const { return size_; }

 private:
  std::size_t room() const { return memory_.size() - std::min(size_, memory_.size()); }

  std::span<std::uint8_t> memory_;
  std::size_t size_ = 0;
};

/// Only counts the bytes.
class ByteCount {
 public:
  void append(const void*, std::size_t size) { size_ += size; }
  void pad(std::size_t size) { size_ += size; }
  std::size_t size() const { return size_; }

 private:
  std::size_t size_ = 0;
};

/// Writes messages by their lists of fields.
template <Wire kFormat, class Output = ByteVector>
class WireWriter {
 public:
  explicit WireWriter(Output output = {}) : output_(std::move(output)) {
    constexpr std::uint8_t kLittleEndianCdr[kHeaderBytes] = {0, 1, 0, 0};
    if constexpr (kFormat == Wire::kCdr) output_.append(kLittleEndianCdr, kHeaderBytes);
  }

  template <class Message>
  void operator()(const Message& message) {
    write(message);
  }
  Output& output() { return output_; }

 private:
  static constexpr std::size_t kHeaderBytes = 4;

  void align(std::size_t size) {
    if constexpr (kFormat == Wire::kCdr) {
      const std::size_t position = output_.size() - kHeaderBytes;
      output_.pad((size - position % size) % size);
    }
  }

  template <class T>
  void write(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      const std::uint8_t byte = value ? 1 : 0;
      output_.append(&byte, 1);
    } else if constexpr (std::is_enum_v<T>) {
      write(static_cast<std::underlying_type_t<T>>(value));
    } else if constexpr (std::is_arithmetic_v<T>) {
      write_numbers(&value, 1);
    } else if constexpr (UnalignedNumber<T>) {
      write(value.value());
    } else {
      for_each_part<kFormat>(value, [this](const auto& part) { write(part); });
    }
  }

  template <class T>
  void write_numbers(const T* values, std::size_t count) {
    align(sizeof(T));
    output_.append(values, count * sizeof(T));
  }

  void write(const std::string& text) {
    constexpr std::size_t kEndMark = kFormat == Wire::kCdr ? 1 : 0;
    write(static_cast<std::uint32_t>(text.size() + kEndMark));
    output_.append(text.c_str(), text.size() + kEndMark);
  }

  template <class T, std::size_t kSize>
  void write(const std::array<T, kSize>& values) {
    if constexpr (std::is_arithmetic_v<T>) {
      write_numbers(values.data(), kSize);
    } else {
      for (const T& value : values) write(value);
    }
  }

  template <class T>
  void write(const std::vector<T>& values) {
    write(static_cast<std::uint32_t>(values.size()));
    if constexpr (std::is_arithmetic_v<T>) {
      if (!values.empty()) write_numbers(values.data(), values.size());
    } else {
      for (const T& value : values) write(value);
    }
  }

  Output output_;
};

/// How many bytes encode() gives.
template <Wire kFormat, class Message>
std::size_t encoded_size(const Message& message) {
  WireWriter<kFormat, ByteCount> counter;
  counter(message);
  return counter.output().size();
}

template <Wire kFormat, class Message>
std::vector<std::uint8_t> encode(const Message& message) {
  ByteVector bytes;
  bytes.reserve(encoded_size<kFormat>(message));
  WireWriter<kFormat> writer(std::move(bytes));
  writer(message);
  return writer.output().take();
}

}  // namespace rtd::ros
