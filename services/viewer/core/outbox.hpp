// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace rtd::viewer {

using Bytes = std::vector<std::byte>;

/// One WebSocket message: a short head of its own and a payload that several clients may share.
struct Frame {
  bool text = false;
  Bytes head;
  std::shared_ptr<const Bytes> payload;
  std::size_t size() const { return head.size() + (payload ? payload->size() : 0); }
};

Frame text_frame(std::string_view text);
Frame binary_frame(Bytes head, std::shared_ptr<const Bytes> payload = nullptr);

/// What waits to be sent to one client, bounded. Control messages are never dropped: a client that does not take them
/// is closed. Of the data the oldest message goes first. One thread.
class Outbox {
 public:
  struct Limits {
    std::size_t control_messages = 1024, control_bytes = 8U << 20U;
    std::size_t data_messages = 1024, data_bytes = 1U << 20U;
  };

  explicit Outbox(const Limits& limits) : limits_(limits) {}
  Outbox() : Outbox(Limits{}) {}

  /// False when the client takes too little and must be closed.
  bool push_control(Frame frame);
  /// Drops older data to make room. A message larger than the limit waits alone.
  void push_data(Frame frame);
  /// The next message: control first.
  std::optional<Frame> pop();

  bool overflowed() const { return overflowed_; }
  std::uint64_t dropped() const { return dropped_; }
  std::size_t bytes() const { return control_bytes_ + data_bytes_; }

 private:
  const Limits limits_;
  std::deque<Frame> control_, data_;
  std::size_t control_bytes_ = 0, data_bytes_ = 0;
  std::uint64_t dropped_ = 0;
  bool overflowed_ = false;
};

static_assert(std::endian::native == std::endian::little, "binary messages are little-endian");

/// Appends values as in binary messages: little-endian, packed.
class ByteWriter {
 public:
  template <class... T>
  explicit ByteWriter(T... values) {
    put(values...);
  }
  template <class... T>
  void put(T... values) {
    static_assert((std::is_trivially_copyable_v<T> && ...));
    (put_bytes(&values, sizeof(T)), ...);
  }
  void put_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), bytes, bytes + size);
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    put_bytes(text.data(), text.size());
  }
  /// Overwrites the value at `position`.
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
