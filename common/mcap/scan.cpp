// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/mcap/stream_reader.hpp"
#include "common/mcap/summary.hpp"

namespace rtd::mcap {
namespace {

/// Makes a summary of the records as they come by.
class Scan {
 public:
  Scan() { summary.scanned = true; }

  void add(const Record& record, const Location& location) {
    std::visit([&](const auto& typed) { take(typed, location); }, record);
  }

  Summary summary;
  Statistics statistics;

 private:
  void take(const Header& header, const Location&) { summary.header = header; }
  void take(const Chunk& chunk, const Location& location) {
    ChunkIndex index;
    index.message_start_time = chunk.message_start_time;
    index.message_end_time = chunk.message_end_time;
    index.chunk_start_offset = location.record.offset;
    index.chunk_length = location.record.end() - location.record.offset;
    index.compression = chunk.compression;
    index.compressed_size = chunk.records.size();
    index.uncompressed_size = chunk.uncompressed_size;
    summary.chunk_indexes.push_back(std::move(index));
    ++statistics.chunk_count;
  }
  void take(const Message& message, const Location& location) {
    const bool first = statistics.message_count++ == 0;
    statistics.message_start_time =
        first ? message.log_time : std::min(statistics.message_start_time, message.log_time);
    statistics.message_end_time = std::max(statistics.message_end_time, message.log_time);
    ++statistics.channel_message_counts[message.channel_id];
    if (location.in_chunk)
      take_in_chunk(message);
    else
      summary.loose_messages.push_back({message.log_time, location.record.offset, message.channel_id});
  }
  /// The times are those of the messages, whatever the head of the chunk says.
  void take_in_chunk(const Message& message) {
    ChunkIndex& index = summary.chunk_indexes.back();
    const bool first = index.message_index_offsets.empty();
    index.message_index_offsets.try_emplace(message.channel_id, 0);
    index.message_start_time = first ? message.log_time : std::min(index.message_start_time, message.log_time);
    index.message_end_time = first ? message.log_time : std::max(index.message_end_time, message.log_time);
  }
  void take(const MessageIndex& index, const Location& location) {
    if (summary.chunk_indexes.empty()) return;
    ChunkIndex& chunk = summary.chunk_indexes.back();
    chunk.message_index_length += location.record.end() - location.record.offset;
    const auto known = chunk.message_index_offsets.find(index.channel_id);
    if (known != chunk.message_index_offsets.end()) known->second = location.record.offset;
  }
  void take(const Attachment& attachment, const Location& location) {
    summary.attachment_indexes.push_back({location.record.offset, location.record.end() - location.record.offset,
                                          attachment.log_time, attachment.create_time, attachment.data.size(),
                                          attachment.name, attachment.media_type});
    ++statistics.attachment_count;
  }
  void take(const Metadata& metadata, const Location& location) {
    summary.metadata_indexes.push_back(
        {location.record.offset, location.record.end() - location.record.offset, metadata.name});
    ++statistics.metadata_count;
  }
  template <class R>
  void take(const R&, const Location&) {}
};

}  // namespace

Summary scan(const ByteSource& source, const ReaderOptions& options, Problems& problems) {
  StreamReader reader(source, options);
  Scan scan;
  while (const Record* record = reader.next()) scan.add(*record, reader.location());
  scan.summary.schemas = reader.schemas();
  scan.summary.channels = reader.channels();
  scan.statistics.schema_count = static_cast<std::uint16_t>(reader.schemas().size());
  scan.statistics.channel_count = static_cast<std::uint32_t>(reader.channels().size());
  scan.summary.statistics = scan.statistics;
  for (const Problem& problem : reader.problems().listed()) problems.add(problem);
  return std::move(scan.summary);
}

}  // namespace rtd::mcap
