// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What StreamReader checks of a record beyond its own fields.
#include <algorithm>
#include <array>

#include "common/io/bytes.hpp"
#include "common/mcap/codec.hpp"
#include "common/mcap/stream_reader.hpp"

namespace rtd::mcap {

bool StreamReader::check_chunk(const Frame& frame, const Chunk& chunk) {
  // Behind times, size, CRC, compression and the length of the records: 40 bytes and the name of the compression.
  const std::uint64_t records_offset = frame.content() + 40 + chunk.compression.size();
  audit_.begin_chunk(frame.offset, frame.end() - frame.offset, chunk);
  const ChunkContent content =
      unpack_limit_.take(chunk.uncompressed_size)
          ? open_chunk(chunk, options_, decompress_, uncompressed_)
          : ChunkContent{{}, ProblemKind::kTooLarge, "what the file unpacks to is too much for its size"};
  if (!content.records) {
    audit_.lose_content();
    report(content.fault, frame.offset, "Chunk: " + content.what, "its messages are left out", true);
    if (position_ == frame.end() && !begins_record(file_, position_))
      position_ = find_record(file_, frame.offset + 1, false).value_or(file_.size());
    return false;
  }
  if (options_.check_crcs && chunk.compression.empty() && chunk.uncompressed_crc != 0 && data_end_ == 0) {
    // The CRC that was just checked is that of the bytes in the file, too.
    extend_crc(records_offset);
    crc_ = io::crc32_combine(crc_, chunk.uncompressed_crc, chunk.records.size());
    crc_end_ = records_offset + chunk.records.size();
  }
  chunk_ = RecordCursor(*content.records);
  return true;
}

/// A record may have unknown fields behind those that are known; but where a record begins right there, its length is
/// wrong, and would swallow what follows.
void StreamReader::check_length(const Frame& frame, std::uint64_t fields_end) {
  if (!begins_record(file_, fields_end)) return;
  report(ProblemKind::kDamagedRecord, frame.offset,
         name_of(frame.opcode) + ": it says " + std::to_string(frame.length) +
             " bytes, but another record begins after " + std::to_string(fields_end - frame.content()),
         "it is read on there");
  position_ = fields_end;
}

/// Loose messages have no CRC of their own. One damaged bit makes a MessageIndex look like one: those are recognised by
/// the length that a MessageIndex has where a Message has its sequence number.
bool StreamReader::check_loose_message(const Frame& frame, ByteView content, const Message& message) {
  constexpr std::uint64_t kIndexHead = 6;
  const bool like_index = message.sequence + kIndexHead == content.size() && message.data.size() % 16 == 0;
  if (data_end_ != 0 || (chunked_ && like_index)) {
    report(ProblemKind::kMisplacedRecord, frame.offset,
           data_end_ != 0 ? "Message: it comes after the DataEnd" : "Message: it has the fields of a MessageIndex",
           "it is left out", true);
    return false;
  }
  if (!definitions_.accept(message, frame.offset)) return false;
  audit_.message();
  return true;
}

void StreamReader::check_statistics(const Frame& frame, const Statistics& statistics) {
  const std::uint64_t seen = audit_.message_count();
  if (seen < statistics.message_count)
    report(ProblemKind::kIndexMismatch, frame.offset,
           "Statistics: " + std::to_string(statistics.message_count) + " messages were written, " +
               std::to_string(seen) + " are read",
           std::to_string(statistics.message_count - seen) + " messages are lost", true);
  else
    check_index(frame, audit_.check(statistics));
}

bool StreamReader::check_attachment(const Frame& frame, ByteView content, const Attachment& attachment) {
  audit_.attachment(frame.offset, frame.end() - frame.offset);
  if (!options_.check_crcs || attachment.crc == 0) return true;
  const auto covered = static_cast<std::size_t>(attachment.data.data() - content.data()) + attachment.data.size();
  const std::uint32_t found = io::crc32(content.first(covered));
  if (found == attachment.crc) return true;
  report(ProblemKind::kCrcMismatch, frame.offset,
         "Attachment \"" + attachment.name + "\": its CRC is " + hex(found) + ", it says " + hex(attachment.crc),
         "it is left out", true);
  return false;
}

void StreamReader::check_data_end(const Frame& frame, const DataEnd& end) {
  if (data_end_ != 0)
    report(ProblemKind::kMisplacedRecord, frame.offset, "DataEnd: a second one", "it is delivered all the same");
  extend_crc(frame.offset);
  if (data_end_ == 0 && options_.check_crcs && end.data_section_crc != 0 && crc_ != end.data_section_crc)
    report(ProblemKind::kCrcMismatch, frame.offset,
           "DataEnd: the CRC of the file up to here is " + hex(crc_) + ", it says " + hex(end.data_section_crc),
           "some byte before is damaged; what is not in a chunk with its own CRC may be wrong");
  data_end_ = frame.end();
}

void StreamReader::check_footer(const Frame& frame, const Footer& footer) {
  check_closing_magic(frame);
  if (data_end_ == 0)
    report(ProblemKind::kMisplacedRecord, frame.offset, "Footer: there is no DataEnd before it",
           "the CRC of the data section is not checked");
  const bool has_summary = footer.summary_start != 0;
  const bool starts_behind_data = footer.summary_start == data_end_;
  // Some writers also say where a summary or offsets would be that they left out: right before the Footer.
  const bool offsets_inside =
      footer.summary_offset_start == 0 ||
      (footer.summary_offset_start >= footer.summary_start && footer.summary_offset_start <= frame.offset);
  if ((has_summary ? !starts_behind_data : data_end_ != 0 && data_end_ != frame.offset) || !offsets_inside) {
    report(ProblemKind::kIndexMismatch, frame.offset, "Footer: its offsets are not those of the summary",
           "the CRC of the summary is not checked");
    return;
  }
  if (!options_.check_crcs || footer.summary_crc == 0) return;
  const std::uint64_t crc_field = frame.content() + 16;
  std::uint32_t found = 0;
  std::uint64_t at = has_summary ? footer.summary_start : frame.offset;
  while (at < crc_field) {
    constexpr std::uint64_t kBlock = 1 << 16;
    const std::optional<ByteView> bytes = file_.view(at, std::min(kBlock, crc_field - at));
    if (!bytes) break;
    found = io::crc32(*bytes, found);
    at += bytes->size();
  }
  if (found != footer.summary_crc)
    report(ProblemKind::kCrcMismatch, frame.offset,
           "Footer: the CRC of the summary is " + hex(found) + ", it says " + hex(footer.summary_crc),
           "the summary may be wrong; the messages are not concerned");
}

void StreamReader::check_closing_magic(const Frame& frame) {
  const std::uint64_t left = file_.size() - frame.end();
  std::array<std::byte, kMagic.size()> magic{};
  const bool closes =
      left == magic.size() && file_.peek(frame.end(), magic) && std::ranges::equal(magic, io::bytes_of(kMagic));
  at_end_ = left <= magic.size() || !begins_record(file_, frame.end());
  if (closes) return;
  if (left < magic.size())
    report(ProblemKind::kTruncated, frame.end(), "the file ends without the closing magic", "nothing is lost by that");
  else if (left == magic.size())
    report(ProblemKind::kNotMcap, frame.end(), "the file does not end with the MCAP magic", "nothing is lost by that");
  else
    report(ProblemKind::kMisplacedRecord, frame.end(), std::to_string(left) + " bytes follow the Footer",
           at_end_ ? "they are not read" : "they look like records and are read on", at_end_);
}

void StreamReader::check_index(const Frame& frame, const std::optional<std::string>& difference) {
  if (difference)
    report(ProblemKind::kIndexMismatch, frame.offset, name_of(frame.opcode) + ": " + *difference,
           "readers that trust it miss or misplace messages; this one does not use it");
}

}  // namespace rtd::mcap
