// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/io/bytes.hpp"
#include "common/io/recording_forms.hpp"

/// The records of an MCAP file, named as in the specification (https://mcap.dev/spec). Times are nanoseconds since an
/// epoch that the recorder chose; offsets are bytes from the start of the file unless said otherwise. A span is a view
/// into a buffer of whoever made the record: it lives as long as that one promises.
namespace rtd::mcap {

using Timestamp = std::uint64_t;
using SchemaId = std::uint16_t;
using ChannelId = std::uint16_t;
using io::Buffer;
using io::Bytes;
using io::ByteView;

inline constexpr std::string_view kMagic = io::kMcapMagic;

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

struct Header {
  static constexpr Opcode kOpcode = Opcode::kHeader;
  std::string profile, library;
};

struct Footer {
  static constexpr Opcode kOpcode = Opcode::kFooter;
  std::uint64_t summary_start = 0;         ///< 0: no summary
  std::uint64_t summary_offset_start = 0;  ///< 0: no summary offsets
  std::uint32_t summary_crc = 0;           ///< of everything from summary_start (or this record) up to here; 0: none
};

struct Schema {
  static constexpr Opcode kOpcode = Opcode::kSchema;
  SchemaId id = 0;  ///< 0 is not allowed
  std::string name, encoding;
  std::string data;  ///< any bytes; text in the encodings of ROS 2 and the OMG
  bool operator==(const Schema&) const = default;
};

struct Channel {
  static constexpr Opcode kOpcode = Opcode::kChannel;
  ChannelId id = 0;
  SchemaId schema_id = 0;  ///< 0: no schema
  std::string topic, message_encoding;
  std::map<std::string, std::string> metadata;
  bool operator==(const Channel&) const = default;
};

struct Message {
  static constexpr Opcode kOpcode = Opcode::kMessage;
  ChannelId channel_id = 0;
  std::uint32_t sequence = 0;
  Timestamp log_time = 0;
  Timestamp publish_time = 0;
  ByteView data;
};

struct Chunk {
  static constexpr Opcode kOpcode = Opcode::kChunk;
  Timestamp message_start_time = 0, message_end_time = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;  ///< 0: none
  std::string compression;
  ByteView records;  ///< as in the file, so still compressed
};

struct MessageIndex {
  static constexpr Opcode kOpcode = Opcode::kMessageIndex;
  ChannelId channel_id = 0;
  std::vector<std::pair<Timestamp, std::uint64_t>> records;  ///< log_time, offset in the uncompressed chunk
};

struct ChunkIndex {
  static constexpr Opcode kOpcode = Opcode::kChunkIndex;
  Timestamp message_start_time = 0, message_end_time = 0;
  std::uint64_t chunk_start_offset = 0;
  std::uint64_t chunk_length = 0;  ///< with opcode and length prefix
  std::map<ChannelId, std::uint64_t> message_index_offsets;
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
};

/// The index of a chunk at `offset`, without its message indexes. `length`: with opcode and length prefix.
inline ChunkIndex index_of(const Chunk& chunk, std::uint64_t offset, std::uint64_t length) {
  ChunkIndex index;
  index.message_start_time = chunk.message_start_time;
  index.message_end_time = chunk.message_end_time;
  index.chunk_start_offset = offset;
  index.chunk_length = length;
  index.compression = chunk.compression;
  index.compressed_size = chunk.records.size();
  index.uncompressed_size = chunk.uncompressed_size;
  return index;
}

struct Attachment {
  static constexpr Opcode kOpcode = Opcode::kAttachment;
  Timestamp log_time = 0, create_time = 0;
  std::string name, media_type;
  ByteView data;
  std::uint32_t crc = 0;  ///< of the fields before it; the writer computes it; 0: none
};

struct AttachmentIndex {
  static constexpr Opcode kOpcode = Opcode::kAttachmentIndex;
  std::uint64_t offset = 0, length = 0;  ///< length with opcode and length prefix
  Timestamp log_time = 0, create_time = 0;
  std::uint64_t data_size = 0;
  std::string name, media_type;
};

struct Statistics {
  static constexpr Opcode kOpcode = Opcode::kStatistics;
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0, attachment_count = 0, metadata_count = 0, chunk_count = 0;
  Timestamp message_start_time = 0, message_end_time = 0;  ///< both 0 when there are no messages
  std::map<ChannelId, std::uint64_t> channel_message_counts;

  void count(const Message& message) {
    message_start_time = message_count == 0 ? message.log_time : std::min(message_start_time, message.log_time);
    message_end_time = std::max(message_end_time, message.log_time);
    ++message_count;
    ++channel_message_counts[message.channel_id];
  }
};

struct Metadata {
  static constexpr Opcode kOpcode = Opcode::kMetadata;
  std::string name;
  std::map<std::string, std::string> metadata;
};

struct MetadataIndex {
  static constexpr Opcode kOpcode = Opcode::kMetadataIndex;
  std::uint64_t offset = 0, length = 0;  ///< length with opcode and length prefix
  std::string name;
};

struct SummaryOffset {
  static constexpr Opcode kOpcode = Opcode::kSummaryOffset;
  Opcode group_opcode{};
  std::uint64_t group_start = 0, group_length = 0;
};

struct DataEnd {
  static constexpr Opcode kOpcode = Opcode::kDataEnd;
  std::uint32_t data_section_crc = 0;  ///< of the file up to this record; 0: none
};

using Record = std::variant<Header, Footer, Schema, Channel, Message, Chunk, MessageIndex, ChunkIndex, Attachment,
                            AttachmentIndex, Statistics, Metadata, MetadataIndex, SummaryOffset, DataEnd>;

}  // namespace rtd::mcap
