// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "common/mcap/layout.hpp"

namespace rtd::mcap {

/// Little-endian integer at `bytes`, which must hold sizeof(T).
template <std::unsigned_integral T>
T load(const std::byte* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value |= static_cast<T>(std::to_integer<T>(bytes[i]) << (8 * i));
  return value;
}

/// Takes fields off the front of a view. Never reads past its end: from the first field that does not fit on, every
/// field stays as it was and ok() is false. What it allocates is bounded by the size of the view.
class Decoder {
 public:
  explicit Decoder(ByteView in) : in_(in) {}

  bool ok() const { return ok_; }
  std::size_t left() const { return in_.size(); }

  template <class... Fields>
  void operator()(Fields&... fields) {
    (get(fields), ...);
  }
  void bytes64(ByteView& data) {
    std::uint64_t length = 0;
    get(length);
    data = take(length);
  }
  void rest(ByteView& data) { data = take(in_.size()); }

 private:
  ByteView take(std::uint64_t length) {
    if (!ok_ || length > in_.size()) {
      ok_ = false;
      return {};
    }
    const ByteView taken = in_.first(length);
    in_ = in_.subspan(length);
    return taken;
  }
  template <std::unsigned_integral T>
  void get(T& value) {
    const ByteView bytes = take(sizeof(T));
    if (ok_) value = load<T>(bytes.data());
  }
  void get(Opcode& value) {
    std::uint8_t byte = 0;
    get(byte);
    value = static_cast<Opcode>(byte);
  }
  ByteView take32() {
    std::uint32_t length = 0;
    get(length);
    return take(length);
  }
  void get(std::string& text) {
    const ByteView bytes = take32();
    text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  template <class Key, class Value>
  void get(std::map<Key, Value>& map) {
    list<Key, Value>([&](Key key, Value value) { map.try_emplace(std::move(key), std::move(value)); });
  }
  template <class Key, class Value>
  void get(std::vector<std::pair<Key, Value>>& entries) {
    list<Key, Value>([&](Key key, Value value) { entries.emplace_back(std::move(key), std::move(value)); });
  }
  template <class Key, class Value, class Add>
  void list(Add add) {
    Decoder entries(take32());
    while (ok_ && entries.left() > 0) {
      Key key{};
      Value value{};
      entries(key, value);
      ok_ = entries.ok();
      if (ok_) add(std::move(key), std::move(value));
    }
  }

  ByteView in_;
  bool ok_ = true;
};

/// The record that `content` (without opcode and length prefix) holds; empty when a field does not fit. Bytes behind
/// the known fields are left alone, as the specification asks.
template <class R>
std::optional<R> decode(ByteView content) {
  R record;
  Decoder decoder(content);
  layout(decoder, record);
  return decoder.ok() ? std::optional(std::move(record)) : std::nullopt;
}

}  // namespace rtd::mcap
