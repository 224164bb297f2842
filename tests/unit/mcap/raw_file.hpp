// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/io/bytes.hpp"
#include "common/mcap/codec.hpp"
#include "common/mcap/records.hpp"

namespace rtd::mcap {

/// A file made record by record; finish() gives it a correct end.
class RawFile {
 public:
  RawFile() {
    Encoder(bytes_).rest(io::bytes_of(kMagic));
    add(Header{"", "test"});
  }
  template <class R>
  RawFile& add(const R& record) {
    append_record(bytes_, record);
    return *this;
  }
  RawFile& add_raw(std::uint8_t opcode, std::uint64_t length, ByteView content) {
    Encoder encoder(bytes_);
    encoder(static_cast<Opcode>(opcode), length);
    encoder.rest(content);
    return *this;
  }
  RawFile& add_channel(ChannelId id = 1, SchemaId schema = 0) { return add(Channel{id, schema, "/a", "cdr", {}}); }
  /// `summary`: records behind the DataEnd.
  Bytes finish(ByteView summary = {}) { return finish(summary, Footer{summary.empty() ? 0 : data_end(), 0, 0}); }
  Bytes finish(ByteView summary, const Footer& footer) {
    add(DataEnd{});
    Encoder(bytes_).rest(summary);
    add(footer);
    Encoder(bytes_).rest(io::bytes_of(kMagic));
    return bytes_;
  }
  std::uint64_t size() const { return bytes_.size(); }
  /// Where the DataEnd will end.
  std::uint64_t data_end() const { return size() + kFrameBytes + 4; }

 private:
  Bytes bytes_;
};

inline Bytes message_record(ChannelId channel, const std::string& data, Timestamp log_time = 5) {
  Bytes record;
  append_record(record, Message{channel, 0, log_time, 5, io::bytes_of(data)});
  return record;
}

inline Chunk chunk_of(ByteView records) {
  return Chunk{5, 5, records.size(), io::crc32(records), "", records};
}

}  // namespace rtd::mcap
