// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/summary.hpp"

#include <algorithm>
#include <array>

#include "common/mcap/crc32.hpp"
#include "common/mcap/decode.hpp"
#include "common/mcap/encode.hpp"
#include "common/mcap/framing.hpp"

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
      !std::ranges::equal(end->last(kMagic.size()), bytes_of(kMagic)))
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

Check lie(const ChunkIndex& index, const std::string& what) {
  return Unusable{ProblemKind::kIndexMismatch, index.chunk_start_offset, "ChunkIndex: " + what};
}

/// The chunk stands where its index says and agrees with it.
Check check_chunk(const SourceWindow& file, const ChunkIndex& index, std::uint64_t from, std::uint64_t to) {
  if (index.chunk_start_offset < from || index.chunk_start_offset > to ||
      index.chunk_length > to - index.chunk_start_offset)
    return lie(index, "the chunk would not be in the data section, or inside another one");
  std::array<std::byte, kFrameBytes + 24> head;
  if (!file.peek(index.chunk_start_offset, head)) return lie(index, "the file cannot be read there");
  const bool is_chunk = static_cast<Opcode>(head[0]) == Opcode::kChunk &&
                        load<std::uint64_t>(head.data() + 1) == index.chunk_length - kFrameBytes;
  if (!is_chunk) return lie(index, "no chunk of " + std::to_string(index.chunk_length) + " bytes stands there");
  const std::byte* const content = head.data() + kFrameBytes;
  const bool agrees = load<std::uint64_t>(content) == index.message_start_time &&
                      load<std::uint64_t>(content + 8) == index.message_end_time &&
                      load<std::uint64_t>(content + 16) == index.uncompressed_size;
  if (!agrees) return lie(index, "its times or size are not those of the chunk");
  return std::nullopt;
}

Check check_chunks(const SourceWindow& file, Summary& summary, std::uint64_t data_end) {
  std::ranges::sort(summary.chunk_indexes, {}, &ChunkIndex::chunk_start_offset);
  std::uint64_t from = kMagic.size();
  for (const ChunkIndex& index : summary.chunk_indexes) {
    if (Check check = check_chunk(file, index, from, data_end)) return check;
    from = index.chunk_start_offset + index.chunk_length;
    for (const auto& [channel, offset] : index.message_index_offsets)
      if (!summary.channels.contains(channel))
        return lie(index, "it names channel " + std::to_string(channel) + ", which is not in the summary");
  }
  return std::nullopt;
}

/// The summary tells of all messages.
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
  if (statistics.channel_count != summary.channels.size() && statistics.message_count > 0)
    return incomplete("does not have all channels");
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
  if (options.check_crcs && footer->summary_crc != 0 && crc32(*bytes) != footer->summary_crc)
    return Unusable{
        ProblemKind::kCrcMismatch, start,
        "the CRC of the summary is " + hex(crc32(*bytes)) + ", the Footer says " + hex(footer->summary_crc)};
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

std::optional<Summary> read_summary(const ByteSource& source, const ReaderOptions& options, Problems& problems) {
  SourceWindow file(source);
  const std::optional<ByteView> magic = file.view(0, kMagic.size());
  if (!magic || !std::ranges::equal(*magic, bytes_of(kMagic))) {
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

}  // namespace rtd::mcap
