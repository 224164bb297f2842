// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/msg/plausible.hpp"
#include "common/msg/ros.hpp"
#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::ros {

/// How a message is written down.
enum class Wire {
  kRos1,  ///< ROS 1: packed, a header begins with a counter, strings without end mark
  kCdr    ///< ROS 2: XCDR1 little endian behind a 4-byte header; numbers aligned, strings end with NUL
};

/// Calls step(part) with each part of a message in the order of the wire.
template <Wire kFormat, class Message>
void for_each_part(Message& message, auto&& step) {
  if constexpr (kFormat == Wire::kRos1 && std::same_as<std::remove_const_t<Message>, msg::Header>) {
    std::uint32_t seq = 0;  // counts the publisher's messages; not used here
    step(seq);
  }
  msg::for_each_field(message, [&](const char*, auto& field) { step(field); });
}

/// A number at any address: msg::Unaligned.
template <class T>
concept UnalignedNumber = requires {
  typename T::Number;
};

/// Reads messages by their lists of fields. What it allocates is bounded by the bytes that it is given, whatever they
/// claim. Throws WireError.
template <Wire kFormat>
class WireReader {
 public:
  explicit WireReader(Bytes bytes) : cursor_(kFormat == Wire::kCdr ? body(bytes) : bytes) {}

  void operator()(auto& message) { read(message); }

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
      for_each_part<kFormat>(value, [this](auto& part) { this->read(part); });
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

/// The message that the bytes hold; bytes behind it are ignored, as DDS pads. Throws WireError, also for a message that
/// no honest program sends (common/msg/plausible.hpp): this is the edge for what comes past bus::Reader, as raw samples
/// and recordings do.
template <class Message>
Message decode(Wire wire, Bytes bytes) {
  Message message;
  if (wire == Wire::kRos1) {
    WireReader<Wire::kRos1>{bytes}(message);
  } else {
    WireReader<Wire::kCdr>{bytes}(message);
  }
  if (const msg::ImplausibleField bad = msg::implausible_field(message)) {
    throw WireError(to_string(bad) + " has a value that no honest program sends");
  }
  return message;
}

/// Where written bytes go: memory that is there already.
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

/// Writes messages by their lists of fields into a ByteSpan or ByteCount.
template <Wire kFormat, class Output>
class WireWriter {
 public:
  explicit WireWriter(Output output = {}) : output_(std::move(output)) {
    constexpr std::uint8_t kLittleEndianCdr[kHeaderBytes] = {0, 1, 0, 0};
    if constexpr (kFormat == Wire::kCdr) output_.append(kLittleEndianCdr, kHeaderBytes);
  }

  void operator()(const auto& message) { write(message); }
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
      for_each_part<kFormat>(value, [this](const auto& part) { this->write(part); });
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
  std::vector<std::uint8_t> bytes(encoded_size<kFormat>(message));
  WireWriter<kFormat, ByteSpan> writer{ByteSpan(bytes)};
  writer(message);
  return bytes;
}

/// In CDR, as the bus takes it.
template <class Message>
std::vector<std::byte> encode_cdr(const Message& message) {
  const std::vector<std::uint8_t> cdr = encode<Wire::kCdr>(message);
  const auto bytes = std::as_bytes(std::span(cdr));
  return {bytes.begin(), bytes.end()};
}

}  // namespace rtd::ros
