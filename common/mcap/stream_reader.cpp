// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/stream_reader.hpp"

#include <algorithm>

#include "common/io/bytes.hpp"
#include "common/mcap/codec.hpp"

namespace rtd::mcap {
namespace {

std::string bytes_text(std::uint64_t count) {
  return std::to_string(count) + " bytes";
}

}  // namespace

StreamReader::StreamReader(const io::ByteSource& source, ReaderOptions options)
    : options_(options),
      problems_(options.max_problems),
      file_(source),
      definitions_(problems_),
      unpack_limit_(source.size()) {}

void StreamReader::assume(const std::map<SchemaId, Schema>& schemas, const std::map<ChannelId, Channel>& channels) {
  for (const auto& [id, schema] : schemas) definitions_.accept(schema, 0);
  for (const auto& [id, channel] : channels) definitions_.accept(channel, 0);
}

const Record* StreamReader::next() {
  if (!started_) {
    started_ = true;
    at_end_ = !begin();
  }
  while (true) {
    if (chunk_) {
      if (const Record* record = next_in_chunk()) return record;
      end_chunk();
    }
    if (at_end_) return nullptr;
    const Step result = step();
    if (result == Step::kRecord) return &record_;
    at_end_ = result == Step::kEnd;
  }
}

bool StreamReader::begin() {
  const std::optional<Frame> header = frame_at(file_, kMagic.size());
  const std::optional<ByteView> magic = file_.view(0, kMagic.size());
  if (magic && std::ranges::equal(*magic, io::bytes_of(kMagic))) {
    position_ = kMagic.size();
    if (header && header->opcode != Opcode::kHeader)
      report(ProblemKind::kMisplacedRecord, position_, "the first record is not a Header",
             "profile and library are not known");
    return true;
  }
  const bool continues = header && header->opcode == Opcode::kHeader && begins_record(file_, kMagic.size());
  report(ProblemKind::kNotMcap, 0, "the file does not begin with the MCAP magic",
         continues ? "a Header follows all the same: it is read on" : "nothing is read: this is not an MCAP file",
         !continues);
  position_ = kMagic.size();
  return continues;
}

StreamReader::Step StreamReader::step() {
  extend_crc(position_);
  const std::uint64_t left = file_.size() - position_;
  if (left == 0) {
    report(ProblemKind::kTruncated, position_, "the file ends without a Footer",
           "whole records up to here are read; there is no summary");
    return Step::kEnd;
  }
  const std::optional<ByteView> head = left < kFrameBytes ? std::nullopt : file_.view(position_, kFrameBytes);
  if (!head) {
    const bool short_tail = left < kFrameBytes;
    report(short_tail ? ProblemKind::kTruncated : ProblemKind::kUnreadable, position_,
           short_tail ? "the file ends inside the head of a record" : "the file cannot be read here",
           "the last " + bytes_text(left) + " are not read", true);
    return Step::kEnd;
  }
  const Frame frame{static_cast<Opcode>((*head)[0]), position_, io::load<std::uint64_t>(head->data() + 1)};
  chunked_ = chunked_ || frame.opcode == Opcode::kChunk;
  return frame.fits(file_.size()) ? read(frame) : cut(frame);
}

/// A record that reaches beyond the end: the file is cut, or its length is damaged and more records follow.
StreamReader::Step StreamReader::cut(const Frame& frame) {
  const std::string what = "it says " + bytes_text(frame.length) + ", the file ends after " +
                           std::to_string(frame.left_in_file(file_.size()));
  if (!is_known(frame.opcode) || find_record(file_, frame.offset + 1, !chunked_)) return damaged(frame, what);
  salvaging_ = options_.salvage_cut_chunk && frame.opcode == Opcode::kChunk && salvage(frame);
  report(ProblemKind::kTruncated, frame.offset, name_of(frame.opcode) + ": " + what,
         salvaging_ ? "the file is cut here: the whole messages before the cut are kept, but no checksum covers them"
                    : "the file is cut here: this record is lost, and what came after it",
         true);
  position_ = file_.size();
  return Step::kEnd;
}

/// Opens what is left of an uncompressed chunk; false when there is nothing to read.
bool StreamReader::salvage(const Frame& frame) {
  const std::uint64_t left = frame.left_in_file(file_.size());
  const std::optional<ByteView> bytes =
      left > options_.max_record_bytes ? std::nullopt : file_.view(frame.content(), left);
  if (!bytes) return false;
  Chunk chunk;
  std::uint64_t announced = 0;
  Decoder decoder(*bytes);
  decoder(chunk.message_start_time, chunk.message_end_time, chunk.uncompressed_size, chunk.uncompressed_crc,
          chunk.compression, announced);
  decoder.rest(chunk.records);
  if (!decoder.ok() || !chunk.compression.empty()) return false;
  audit_.begin_chunk(frame.offset, kFrameBytes + left, chunk);
  location_ = {frame};
  chunk_ = RecordCursor(chunk.records);
  return true;
}

/// Continues behind the record where its length can be trusted, else at the next place that looks like a record.
StreamReader::Step StreamReader::damaged(const Frame& frame, const std::string& what) {
  audit_.lose_chunk();
  std::optional<std::uint64_t> next;
  if (frame.fits(file_.size()) && begins_record(file_, frame.end()))
    next = frame.end();
  else
    next = find_record(file_, frame.offset + 1, !chunked_);
  position_ = next.value_or(file_.size());
  report(ProblemKind::kDamagedRecord, frame.offset, name_of(frame.opcode) + ": " + what,
         bytes_text(position_ - frame.offset) + " are skipped" + (next ? "" : ": no record follows"), true);
  return next ? Step::kNothing : Step::kEnd;
}

StreamReader::Step StreamReader::leave_out(const Frame& frame, ProblemKind kind, const std::string& what) {
  report(kind, frame.offset, name_of(frame.opcode) + ": " + what, "it is left out", true);
  position_ = frame.end();
  return Step::kNothing;
}

StreamReader::Step StreamReader::skip_unknown(const Frame& frame) {
  if (frame.opcode == Opcode{} || !begins_record(file_, frame.end()))
    return damaged(frame, "its type is not known and no record follows it");
  report(ProblemKind::kUnknownRecord, frame.offset, name_of(frame.opcode) + ": not known",
         bytes_text(frame.end() - frame.offset) + " are skipped, as the format asks");
  position_ = frame.end();
  return Step::kNothing;
}

StreamReader::Step StreamReader::read(const Frame& frame) {
  if (!is_known(frame.opcode)) return skip_unknown(frame);
  if (frame.length > options_.max_record_bytes)
    return leave_out(frame, ProblemKind::kTooLarge,
                     "its " + bytes_text(frame.length) + " are above the reader's limit of " +
                         std::to_string(options_.max_record_bytes));
  const std::optional<ByteView> bytes = file_.view(frame.offset, kFrameBytes + frame.length);
  if (!bytes) return leave_out(frame, ProblemKind::kUnreadable, "the file cannot be read here");
  return dispatch(frame, bytes->subspan(kFrameBytes), record_);
}

/// As the type of the variant whose opcode it has.
template <class... R>
StreamReader::Step StreamReader::dispatch(const Frame& frame, ByteView content, const std::variant<R...>& /*types*/) {
  Step step = Step::kNothing;
  (void)((frame.opcode == R::kOpcode && (step = read_as<R>(frame, content), true)) || ...);
  return step;
}

template <class R>
StreamReader::Step StreamReader::read_as(const Frame& frame, ByteView content) {
  R record;
  Decoder decoder(content);
  layout(decoder, record);
  if (!decoder.ok()) return damaged(frame, "its fields do not fit into its " + bytes_text(frame.length));
  location_ = {frame};
  position_ = frame.end();
  if (decoder.left() > 0) check_length(frame, frame.end() - decoder.left());
  if (!check(frame, content, record)) return Step::kNothing;
  record_ = std::move(record);
  return Step::kRecord;
}

template <class R>
bool StreamReader::check(const Frame& frame, ByteView content, const R& record) {
  if (data_end_ != 0) audit_.summary_record(frame.opcode, frame.offset, frame.end() - frame.offset);
  if constexpr (std::is_same_v<R, Schema> || std::is_same_v<R, Channel>) {
    return definitions_.accept(record, frame.offset);
  } else if constexpr (std::is_same_v<R, Message>) {
    return check_loose_message(frame, content, record);
  } else if constexpr (std::is_same_v<R, Chunk>) {
    return check_chunk(frame, record);
  } else if constexpr (std::is_same_v<R, Attachment>) {
    return check_attachment(frame, content, record);
  } else if constexpr (std::is_same_v<R, Metadata>) {
    audit_.metadata(frame.offset, frame.end() - frame.offset);
  } else if constexpr (std::is_same_v<R, DataEnd>) {
    check_data_end(frame, record);
  } else if constexpr (std::is_same_v<R, Footer>) {
    check_footer(frame, record);
  } else if constexpr (std::is_same_v<R, Statistics>) {
    check_statistics(frame, record);
  } else if constexpr (std::is_same_v<R, MessageIndex>) {
    check_index(frame, audit_.check(frame.offset, frame.end() - frame.offset, record));
  } else if constexpr (std::is_same_v<R, Header>) {
    if (frame.offset != kMagic.size())
      report(ProblemKind::kMisplacedRecord, frame.offset, "Header: it is not the first record",
             "it is delivered as it is");
  } else {
    check_index(frame, audit_.check(record));
  }
  return true;
}

const Record* StreamReader::next_in_chunk() {
  while (const std::optional<InnerRecord> inner = chunk_->next()) {
    location_.in_chunk = true;
    location_.offset_in_chunk = inner->offset;
    if (inner->opcode == Opcode::kSchema    ? take_inner<Schema>(*inner)
        : inner->opcode == Opcode::kChannel ? take_inner<Channel>(*inner)
        : inner->opcode == Opcode::kMessage ? take_inner<Message>(*inner)
                                            : take_inner<Record>(*inner))
      return &record_;
  }
  return nullptr;
}

/// R = Record: any type that does not belong into a chunk.
template <class R>
bool StreamReader::take_inner(const InnerRecord& inner) {
  const std::uint64_t chunk = location_.record.offset;
  const auto named = [&] { return name_of(inner.opcode) + " at " + std::to_string(inner.offset) + " in a chunk"; };
  if constexpr (std::is_same_v<R, Record>) {
    const bool known = is_known(inner.opcode);
    report(known ? ProblemKind::kMisplacedRecord : ProblemKind::kUnknownRecord, chunk, named(), "it is skipped", known);
    return false;
  } else {
    std::optional<R> record = decode<R>(inner.content);
    if (!record) {
      report(ProblemKind::kDamagedRecord, chunk, named() + ": its fields do not fit", "it is skipped", true);
      return false;
    }
    if (!definitions_.accept(*record, chunk)) return false;
    if constexpr (std::is_same_v<R, Message>) audit_.message_in_chunk(*record, inner.offset);
    record_ = std::move(*record);
    return true;
  }
}

void StreamReader::end_chunk() {
  if (salvaging_) return chunk_.reset();  // reported where it was cut
  const std::uint64_t chunk = location_.record.offset;
  if (chunk_->cut())
    report(ProblemKind::kDamagedRecord, chunk,
           "Chunk: the record at " + std::to_string(chunk_->position()) + " in it is longer than the rest of the chunk",
           "the last " + bytes_text(chunk_->left()) + " of the chunk are skipped", true);
  check_index(location_.record, audit_.end_chunk());
  chunk_.reset();
}

void StreamReader::extend_crc(std::uint64_t end) {
  constexpr std::uint64_t kBlock = 1 << 16;
  while (options_.check_crcs && data_end_ == 0 && crc_end_ < end) {
    const std::uint64_t count = std::min(kBlock, end - crc_end_);
    // An unreadable place is reported where its record is read.
    if (const std::optional<ByteView> bytes = file_.view(crc_end_, count)) crc_ = io::crc32(*bytes, crc_);
    crc_end_ += count;
  }
}

void StreamReader::report(ProblemKind kind, std::uint64_t offset, std::string what, std::string consequence,
                          bool lost) {
  problems_.add({kind, offset, std::move(what), std::move(consequence), lost});
}

}  // namespace rtd::mcap
