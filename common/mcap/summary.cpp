// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/summary.hpp"

#include <algorithm>
#include <array>

#include "common/io/bytes.hpp"
#include "common/io/unpacked.hpp"
#include "common/mcap/codec.hpp"
#include "common/mcap/stream_reader.hpp"

namespace rtd::mcap {
namespace {

constexpr std::uint64_t kFooterBytes = kFrameBytes + 20;

struct Unusable {
  ProblemKind kind{};
  std::uint64_t offset = 0;
  std::string what;
};
using Check = std::optional<Unusable>;

/// The footer of a file that ends as it should.
std::optional<Footer> footer_of(SourceWindow& file) {
  if (file.size() < 2 * kMagic.size() + kFooterBytes) return std::nullopt;
  const std::uint64_t offset = file.size() - kMagic.size() - kFooterBytes;
  const std::optional<ByteView> end = file.view(offset, kFooterBytes + kMagic.size());
  const std::optional<Frame> frame = frame_at(file, offset);
  if (!end || !frame || frame->opcode != Opcode::kFooter || frame->length != 20 ||
      !std::ranges::equal(end->last(kMagic.size()), io::bytes_of(kMagic)))
    return std::nullopt;
  return decode<Footer>(end->subspan(kFrameBytes, 20));
}

template <class R>
bool keep(ByteView content, std::vector<R>& records) {
  std::optional<R> record = decode<R>(content);
  if (record) records.push_back(std::move(*record));
  return record.has_value();
}

template <class Id, class R>
bool keep(ByteView content, std::map<Id, R>& records) {
  const std::optional<R> record = decode<R>(content);
  if (record) records.try_emplace(record->id, *record);
  return record.has_value();
}

bool keep(const InnerRecord& record, Summary& summary) {
  switch (record.opcode) {
    case Opcode::kSchema:
      return keep(record.content, summary.schemas);
    case Opcode::kChannel:
      return keep(record.content, summary.channels);
    case Opcode::kChunkIndex:
      return keep(record.content, summary.chunk_indexes);
    case Opcode::kAttachmentIndex:
      return keep(record.content, summary.attachment_indexes);
    case Opcode::kMetadataIndex:
      return keep(record.content, summary.metadata_indexes);
    case Opcode::kStatistics:
      summary.statistics = decode<Statistics>(record.content);
      return summary.statistics.has_value();
    default:
      return true;
  }
}

Check read_records(ByteView bytes, std::uint64_t offset, Summary& summary) {
  RecordCursor records(bytes);
  while (const std::optional<InnerRecord> record = records.next())
    if (!keep(*record, summary))
      return Unusable{ProblemKind::kDamagedRecord, offset + record->offset,
                      name_of(record->opcode) + " in the summary: its fields do not fit"};
  if (records.cut())
    return Unusable{ProblemKind::kDamagedRecord, offset + records.position(), "a record is longer than the summary"};
  return std::nullopt;
}

Check mismatch(const ChunkIndex& index, const std::string& what) {
  return Unusable{ProblemKind::kIndexMismatch, index.chunk_start_offset, "ChunkIndex: " + what};
}

/// The chunk is where its index says and agrees with it.
Check check_chunk(const SourceWindow& file, const ChunkIndex& index, std::uint64_t from, std::uint64_t to) {
  if (index.chunk_start_offset < from || index.chunk_start_offset > to ||
      index.chunk_length > to - index.chunk_start_offset)
    return mismatch(index, "the chunk would not be in the data section, or inside another one");
  std::array<std::byte, kFrameBytes + 24> head;
  if (!file.peek(index.chunk_start_offset, head)) return mismatch(index, "the file cannot be read there");
  const bool is_chunk = static_cast<Opcode>(head[0]) == Opcode::kChunk &&
                        io::load<std::uint64_t>(head.data() + 1) == index.chunk_length - kFrameBytes;
  if (!is_chunk) return mismatch(index, "no chunk of " + std::to_string(index.chunk_length) + " bytes is there");
  const std::byte* const content = head.data() + kFrameBytes;
  const bool agrees = io::load<std::uint64_t>(content) == index.message_start_time &&
                      io::load<std::uint64_t>(content + 8) == index.message_end_time &&
                      io::load<std::uint64_t>(content + 16) == index.uncompressed_size;
  if (!agrees) return mismatch(index, "its times or size are not those of the chunk");
  return std::nullopt;
}

Check check_chunks(const SourceWindow& file, Summary& summary, std::uint64_t data_end) {
  std::ranges::sort(summary.chunk_indexes, {}, &ChunkIndex::chunk_start_offset);
  std::uint64_t from = kMagic.size();
  io::UnpackLimit unpack_limit(file.size());
  for (const ChunkIndex& index : summary.chunk_indexes) {
    if (!unpack_limit.take(index.uncompressed_size))
      return mismatch(index, "the chunks unpack to too much for the file");
    if (Check check = check_chunk(file, index, from, data_end)) return check;
    from = index.chunk_start_offset + index.chunk_length;
    for (const auto& [channel, offset] : index.message_index_offsets)
      if (!summary.channels.contains(channel))
        return mismatch(index, "it names channel " + std::to_string(channel) + ", which is not in the summary");
  }
  return std::nullopt;
}

/// The summary covers all messages.
Check check_complete(const Summary& summary, std::uint64_t offset) {
  const auto incomplete = [&](const std::string& what) {
    return Unusable{ProblemKind::kNoSummary, offset, "the summary " + what};
  };
  const bool has_chunks = !summary.chunk_indexes.empty();
  if (!summary.statistics && !has_chunks) return incomplete("has neither statistics nor chunk indexes");
  if (has_chunks && summary.channels.empty()) return incomplete("has no channels");
  for (const auto& [id, channel] : summary.channels)
    if (channel.schema_id != 0 && !summary.schemas.contains(channel.schema_id))
      return incomplete("does not have all schemas");
  if (!summary.statistics) return std::nullopt;
  const Statistics& statistics = *summary.statistics;
  if (statistics.chunk_count != summary.chunk_indexes.size())
    return incomplete("counts " + std::to_string(statistics.chunk_count) + " chunks, but indexes " +
                      std::to_string(summary.chunk_indexes.size()));
  if (statistics.message_count > 0 && !has_chunks) return incomplete("does not index the messages");
  // Some writers do not count channels without messages.
  if (statistics.channel_count > summary.channels.size() && statistics.message_count > 0)
    return incomplete("does not have all channels");
  for (const auto& [channel, messages] : statistics.channel_message_counts)
    if (messages > 0 && has_chunks && !summary.channels.contains(channel))
      return incomplete("does not have channel " + std::to_string(channel));
  return std::nullopt;
}

Check read_checked(SourceWindow& file, const ReaderOptions& options, Summary& summary) {
  const std::optional<Footer> footer = footer_of(file);
  if (!footer) return Unusable{ProblemKind::kTruncated, file.size(), "the file does not end with a Footer"};
  const std::uint64_t footer_offset = file.size() - kMagic.size() - kFooterBytes;
  const std::uint64_t start = footer->summary_start;
  if (start == 0) return Unusable{ProblemKind::kNoSummary, footer_offset, "the file has no summary"};
  if (start < kMagic.size() || start > footer_offset || footer_offset - start > options.max_record_bytes)
    return Unusable{ProblemKind::kIndexMismatch, footer_offset,
                    "Footer: no summary can be at offset " + std::to_string(start)};
  const std::optional<ByteView> bytes = file.view(start, footer_offset + kFrameBytes + 16 - start);
  if (!bytes) return Unusable{ProblemKind::kUnreadable, start, "the summary cannot be read"};
  if (options.check_crcs && footer->summary_crc != 0 && io::crc32(*bytes) != footer->summary_crc)
    return Unusable{
        ProblemKind::kCrcMismatch, start,
        "the CRC of the summary is " + hex(io::crc32(*bytes)) + ", the Footer says " + hex(footer->summary_crc)};
  if (Check check = read_records(bytes->first(footer_offset - start), start, summary)) return check;
  if (Check check = check_complete(summary, start)) return check;
  return check_chunks(file, summary, start);
}

void read_header(SourceWindow& file, const ReaderOptions& options, Header& header) {
  const std::optional<Frame> frame = frame_at(file, kMagic.size());
  if (!frame || frame->opcode != Opcode::kHeader || frame->length > options.max_record_bytes) return;
  if (const std::optional<ByteView> content = file.view(frame->content(), frame->length))
    header = decode<Header>(*content).value_or(Header{});
}

}  // namespace

std::optional<Summary> read_summary(const io::ByteSource& source, const ReaderOptions& options, Problems& problems) {
  SourceWindow file(source);
  const std::optional<ByteView> magic = file.view(0, kMagic.size());
  if (!magic || !std::ranges::equal(*magic, io::bytes_of(kMagic))) {
    problems.add({ProblemKind::kNotMcap, 0, "the file does not begin with the MCAP magic", "its summary is not used"});
    return std::nullopt;
  }
  Summary summary;
  if (const Check check = read_checked(file, options, summary)) {
    problems.add({check->kind, check->offset, check->what, "the file is read from the start instead"});
    return std::nullopt;
  }
  read_header(file, options, summary.header);
  return summary;
}

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
    const Frame& record = location.record;
    summary.chunk_indexes.push_back(index_of(chunk, record.offset, record.end() - record.offset));
    ++statistics.chunk_count;
  }
  void take(const Message& message, const Location& location) {
    statistics.count(message);
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

Summary scan(const io::ByteSource& source, const ReaderOptions& options, Problems& problems) {
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
