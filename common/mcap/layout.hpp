// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <type_traits>

#include "common/mcap/records.hpp"

/// The fields of each record in file order, written once for both directions: `io` is the encoder (const record) or the
/// decoder. io(fields...) takes integers, strings and maps; io.bytes64 a view with a 64-bit length; io.rest a view up
/// to the end of the record.
namespace rtd::mcap {

template <class R, class T>
concept Is = std::same_as<std::remove_const_t<R>, T>;

template <class Io>
void layout(Io& io, Is<Header> auto& r) {
  io(r.profile, r.library);
}
template <class Io>
void layout(Io& io, Is<Footer> auto& r) {
  io(r.summary_start, r.summary_offset_start, r.summary_crc);
}
template <class Io>
void layout(Io& io, Is<Schema> auto& r) {
  io(r.id, r.name, r.encoding, r.data);
}
template <class Io>
void layout(Io& io, Is<Channel> auto& r) {
  io(r.id, r.schema_id, r.topic, r.message_encoding, r.metadata);
}
template <class Io>
void layout(Io& io, Is<Message> auto& r) {
  io(r.channel_id, r.sequence, r.log_time, r.publish_time);
  io.rest(r.data);
}
template <class Io>
void layout(Io& io, Is<Chunk> auto& r) {
  io(r.message_start_time, r.message_end_time, r.uncompressed_size, r.uncompressed_crc, r.compression);
  io.bytes64(r.records);
}
template <class Io>
void layout(Io& io, Is<MessageIndex> auto& r) {
  io(r.channel_id, r.records);
}
template <class Io>
void layout(Io& io, Is<ChunkIndex> auto& r) {
  io(r.message_start_time, r.message_end_time, r.chunk_start_offset, r.chunk_length, r.message_index_offsets,
     r.message_index_length, r.compression, r.compressed_size, r.uncompressed_size);
}
template <class Io>
void layout(Io& io, Is<Attachment> auto& r) {
  io(r.log_time, r.create_time, r.name, r.media_type);
  io.bytes64(r.data);
  io(r.crc);
}
template <class Io>
void layout(Io& io, Is<AttachmentIndex> auto& r) {
  io(r.offset, r.length, r.log_time, r.create_time, r.data_size, r.name, r.media_type);
}
template <class Io>
void layout(Io& io, Is<Statistics> auto& r) {
  io(r.message_count, r.schema_count, r.channel_count, r.attachment_count, r.metadata_count, r.chunk_count,
     r.message_start_time, r.message_end_time, r.channel_message_counts);
}
template <class Io>
void layout(Io& io, Is<Metadata> auto& r) {
  io(r.name, r.metadata);
}
template <class Io>
void layout(Io& io, Is<MetadataIndex> auto& r) {
  io(r.offset, r.length, r.name);
}
template <class Io>
void layout(Io& io, Is<SummaryOffset> auto& r) {
  io(r.group_opcode, r.group_start, r.group_length);
}
template <class Io>
void layout(Io& io, Is<DataEnd> auto& r) {
  io(r.data_section_crc);
}

}  // namespace rtd::mcap
