// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <stdexcept>

#include "common/mcap/layout.hpp"

namespace rtd::mcap {

using Bytes = std::vector<std::byte>;

/// Bytes of an opcode and a length prefix.
constexpr std::size_t kFrameBytes = 9;

inline ByteView bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// Appends fields to a buffer, little-endian on any host. Throws std::length_error when a field with a 32-bit length is
/// longer than 4 GiB.
class Encoder {
 public:
  explicit Encoder(Bytes& out) : out_(out) {}

  template <class... Fields>
  void operator()(const Fields&... fields) {
    (put(fields), ...);
  }
  void bytes64(ByteView data) {
    put(std::uint64_t{data.size()});
    rest(data);
  }
  void rest(ByteView data) { out_.insert(out_.end(), data.begin(), data.end()); }

  static void store(std::byte* at, std::unsigned_integral auto value) {
    for (std::size_t i = 0; i < sizeof(value); ++i) at[i] = static_cast<std::byte>(value >> (8 * i));
  }

 private:
  void put(std::unsigned_integral auto value) {
    std::byte bytes[sizeof(value)];
    store(bytes, value);
    rest(bytes);
  }
  void put(Opcode value) { out_.push_back(static_cast<std::byte>(value)); }
  void put(const std::string& text) {
    put(length32(text.size()));
    rest(bytes_of(text));
  }
  template <class Key, class Value>
  void put(const std::map<Key, Value>& map) {
    list(map);
  }
  template <class Key, class Value>
  void put(const std::vector<std::pair<Key, Value>>& entries) {
    list(entries);
  }
  void list(const auto& entries) {
    const std::size_t start = out_.size();
    put(std::uint32_t{0});
    for (const auto& [key, value] : entries) (*this)(key, value);
    const std::uint32_t length = length32(out_.size() - start - sizeof(std::uint32_t));
    store(out_.data() + start, length);
  }
  static std::uint32_t length32(std::size_t length) {
    if (length > std::numeric_limits<std::uint32_t>::max())
      throw std::length_error("MCAP: a text, map or array of " + std::to_string(length) +
                              " bytes is longer than 4 GiB");
    return static_cast<std::uint32_t>(length);
  }

  Bytes& out_;
};

/// Appends a whole record; `padding` goes behind its fields, as a later version of the format could add some.
template <class R>
void append_record(Bytes& out, const R& record, ByteView padding = {}) {
  const std::size_t start = out.size();
  Encoder encoder(out);
  encoder(R::kOpcode, std::uint64_t{0});
  layout(encoder, record);
  encoder.rest(padding);
  Encoder::store(out.data() + start + 1, std::uint64_t{out.size() - start - kFrameBytes});
}

}  // namespace rtd::mcap
