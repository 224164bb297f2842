// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "common/io/byte_sink.hpp"
#include "common/mcap/codec.hpp"
#include "common/mcap/compression.hpp"

namespace rtd::mcap {

/// What two schemas, and two channels, with the same meaning have in common: all but their ids.
inline auto meaning_of(const Schema& schema) {
  return std::tie(schema.name, schema.encoding, schema.data);
}
inline auto meaning_of(const Channel& channel) {
  return std::tie(channel.topic, channel.schema_id, channel.message_encoding, channel.metadata);
}

/// The defaults make a file that every reader can open by index and check in full.
struct WriterOptions {
  std::string profile;               ///< e.g. "ros2"
  std::string library = "rtd-slam";  ///< who wrote it, free text
  Compression compression = Compression::kNone;
  std::uint64_t chunk_size = 1 << 20;  ///< bytes before compression; a longer message has a chunk for itself
  /// Repeats the schemas and channels that a chunk uses inside it: a chunk can then be read when all others are lost.
  bool self_contained_chunks = false;

  // The optional parts of the format, as its conformance set names them.
  bool use_chunks = true;
  bool use_message_index = true;
  bool use_statistics = true;
  bool use_repeated_schemas = true;
  bool use_repeated_channels = true;
  bool use_attachment_index = true;
  bool use_metadata_index = true;
  bool use_chunk_index = true;
  bool use_summary_offset = true;
  /// Unknown bytes behind the fields of the records that may grow: to test readers.
  bool add_extra_data_to_records = false;
};

/// Up to where a file holds whole records, and how many messages those are.
struct Written {
  std::uint64_t offset = 0;
  std::uint64_t messages = 0;
};

/// Writes one MCAP file. Strict: what the format does not allow throws std::invalid_argument and leaves the file as it
/// was. A sink's io::IoError passes through; nothing of the failed record is then in the file and the call may be
/// repeated. For one thread. Destroying it without close() leaves the file as a crash would: readable, without summary.
class Writer {
 public:
  /// Begins the file. `sink` must be empty and outlive the writer.
  explicit Writer(io::ByteSink& sink, WriterOptions options = {});
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Writes a record with the id that it has; the same id again must come with the same content and is then ignored.
  void write(const Schema& schema);
  void write(const Channel& channel);
  /// The id of the record that was written with this content, whatever id the argument has; else writes it with the
  /// lowest free one from 1 on.
  SchemaId add(Schema schema);
  ChannelId add(Channel channel);

  /// Copies the data once, into the open chunk; where it does not fit, that chunk is ended first.
  void write(const Message& message);
  /// Written at once, before the open chunk.
  void write(const Attachment& attachment);
  void write(const Metadata& metadata);

  /// Puts the open chunk, if it has a message, and its index into the sink with one append().
  void end_chunk();
  std::uint64_t open_chunk_bytes() const { return chunk_.records.size(); }
  std::uint64_t open_chunk_messages() const { return chunk_.messages.message_count; }
  /// What is in the sink. After `w = written()`, a sink.sync() that returns at least w.offset made w.messages durable.
  Written written() const { return {offset_, statistics_.message_count - chunk_.messages.message_count}; }
  const Statistics& statistics() const { return statistics_; }  ///< with the open chunk

  /// Ends the file: open chunk, DataEnd, summary, footer. Writing more is an error then; close() again does nothing.
  void close();
  /// close(), then begins the next file in an empty sink with the same options, schemas and channels.
  void split(io::ByteSink& next);

 private:
  /// The records of a chunk before it is compressed.
  struct OpenChunk {
    Bytes records;
    std::map<ChannelId, MessageIndex> indexes;  ///< in the order of the messages, as the conformance set has them
    Statistics messages;
  };
  template <class Id, class R>
  using Ids = std::map<decltype(meaning_of(std::declval<const R&>())), Id>;

  void begin();
  void require_open() const;
  template <class R>
  void define(const R& record);
  void clear_chunk();
  void repeat_definitions(ChannelId id);
  ByteView padding() const;
  void append(ByteView record);
  void append(ByteView head, ByteView body, std::uint32_t body_crc, ByteView tail);

  io::ByteSink* sink_;
  WriterOptions options_;
  std::map<SchemaId, Schema> schemas_;
  std::map<ChannelId, Channel> channels_;
  Ids<SchemaId, Schema> schema_ids_;  ///< the keys are those records
  Ids<ChannelId, Channel> channel_ids_;
  OpenChunk chunk_;
  std::set<ChannelId> defined_in_chunk_;
  Buffer compressed_;
  Statistics statistics_;
  std::vector<ChunkIndex> chunk_indexes_;
  std::vector<AttachmentIndex> attachment_indexes_;
  std::vector<MetadataIndex> metadata_indexes_;
  std::uint64_t offset_ = 0;
  std::uint32_t data_crc_ = 0;
  bool closed_ = false;
};

}  // namespace rtd::mcap
