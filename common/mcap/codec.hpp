// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <limits>
#include <optional>
#include <ranges>
#include <stdexcept>
#include <type_traits>

#include "common/mcap/records.hpp"

/// The fields of each record in file order, written once for both directions: `io` is the encoder (const record) or the
/// decoder. io(fields...) takes integers, strings and maps; io.bytes64 a view with a 64-bit length; io.rest a view up
/// to the end of the record.
namespace rtd::mcap {

template <class R, class T>
concept Is = std::same_as<std::remove_const_t<R>, T>;

void layout(auto& io, Is<Header> auto& r) {
  io(r.profile, r.library);
}
void layout(auto& io, Is<Footer> auto& r) {
  io(r.summary_start, r.summary_offset_start, r.summary_crc);
}
void layout(auto& io, Is<Schema> auto& r) {
  io(r.id, r.name, r.encoding, r.data);
}
void layout(auto& io, Is<Channel> auto& r) {
  io(r.id, r.schema_id, r.topic, r.message_encoding, r.metadata);
}
void layout(auto& io, Is<Message> auto& r) {
  io(r.channel_id, r.sequence, r.log_time, r.publish_time);
  io.rest(r.data);
}
void layout(auto& io, Is<Chunk> auto& r) {
  io(r.message_start_time, r.message_end_time, r.uncompressed_size, r.uncompressed_crc, r.compression);
  io.bytes64(r.records);
}
void layout(auto& io, Is<MessageIndex> auto& r) {
  io(r.channel_id, r.records);
}
void layout(auto& io, Is<ChunkIndex> auto& r) {
  io(r.message_start_time, r.message_end_time, r.chunk_start_offset, r.chunk_length, r.message_index_offsets,
     r.message_index_length, r.compression, r.compressed_size, r.uncompressed_size);
}
void layout(auto& io, Is<Attachment> auto& r) {
  io(r.log_time, r.create_time, r.name, r.media_type);
  io.bytes64(r.data);
  io(r.crc);
}
void layout(auto& io, Is<AttachmentIndex> auto& r) {
  io(r.offset, r.length, r.log_time, r.create_time, r.data_size, r.name, r.media_type);
}
void layout(auto& io, Is<Statistics> auto& r) {
  io(r.message_count, r.schema_count, r.channel_count, r.attachment_count, r.metadata_count, r.chunk_count,
     r.message_start_time, r.message_end_time, r.channel_message_counts);
}
void layout(auto& io, Is<Metadata> auto& r) {
  io(r.name, r.metadata);
}
void layout(auto& io, Is<MetadataIndex> auto& r) {
  io(r.offset, r.length, r.name);
}
void layout(auto& io, Is<SummaryOffset> auto& r) {
  io(r.group_opcode, r.group_start, r.group_length);
}
void layout(auto& io, Is<DataEnd> auto& r) {
  io(r.data_section_crc);
}

/// Bytes of an opcode and a length prefix.
constexpr std::size_t kFrameBytes = 9;

/// Appends fields to a buffer, little-endian on any host. Throws std::length_error when a field with a 32-bit length is
/// longer than 4 GiB.
class Encoder {
 public:
  explicit Encoder(Bytes& out) : out_(out) {}

  void operator()(const auto&... fields) { (put(fields), ...); }
  void bytes64(ByteView data) {
    put(std::uint64_t{data.size()});
    rest(data);
  }
  void rest(ByteView data) { out_.insert(out_.end(), data.begin(), data.end()); }

 private:
  void put(std::unsigned_integral auto value) {
    std::byte bytes[sizeof(value)];
    io::store(bytes, value);
    rest(bytes);
  }
  void put(Opcode value) { out_.push_back(static_cast<std::byte>(value)); }
  void put(const std::string& text) {
    put(length32(text.size()));
    rest(io::bytes_of(text));
  }
  /// A map or pairs.
  void put(const std::ranges::range auto& entries) {
    const std::size_t start = out_.size();
    put(std::uint32_t{0});
    for (const auto& [key, value] : entries) (*this)(key, value);
    const std::uint32_t length = length32(out_.size() - start - sizeof(std::uint32_t));
    io::store(out_.data() + start, length);
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
  io::store(out.data() + start + 1, std::uint64_t{out.size() - start - kFrameBytes});
}

/// Takes fields off the front of a view. Never reads past its end: from the first field that does not fit on, every
/// field stays as it was and ok() is false. What it allocates is bounded by the size of the view.
class Decoder {
 public:
  explicit Decoder(ByteView in) : in_(in) {}

  bool ok() const { return ok_; }
  std::size_t left() const { return in_.size(); }

  void operator()(auto&... fields) { (get(fields), ...); }
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
    if (ok_) value = io::load<T>(bytes.data());
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
