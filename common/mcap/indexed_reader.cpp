// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/indexed_reader.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "common/io/bytes.hpp"
#include "common/mcap/codec.hpp"
#include "common/mcap/framing.hpp"

namespace rtd::mcap {
namespace {

/// What a message is found by; its data is not looked at.
std::optional<Message> head_of(const InnerRecord& record) {
  return record.opcode == Opcode::kMessage ? decode<Message>(record.content) : std::nullopt;
}

}  // namespace

IndexedReader::IndexedReader(const io::ByteSource& source, ReaderOptions options)
    : options_(options),
      problems_(options.max_problems),
      file_(source),
      definitions_(problems_),
      cache_(file_, options_) {
  std::optional<Summary> summary = read_summary(source, options_, problems_);
  summary_ = summary ? std::move(*summary) : scan(source, options_, problems_);
  for (const auto& [id, schema] : summary_.schemas) definitions_.accept(schema, 0);
  std::erase_if(summary_.channels, [&](const auto& channel) { return !definitions_.accept(channel.second, 0); });
}

MessageCursor IndexedReader::messages(MessageQuery query) {
  return {*this, std::move(query)};
}

bool IndexedReader::selects(const MessageQuery& query, ChannelId channel, Timestamp log_time) const {
  if (log_time < query.start || log_time > query.end) return false;
  const auto known = definitions_.channels().find(channel);
  return known != definitions_.channels().end() && (!query.wanted || query.wanted(known->second));
}

bool IndexedReader::may_hold(const ChunkIndex& index, const MessageQuery& query) const {
  if (index.message_end_time < query.start || index.message_start_time > query.end) return false;
  return index.message_index_offsets.empty() ||
         std::ranges::any_of(index.message_index_offsets, [&](const auto& entry) {
           const auto known = definitions_.channels().find(entry.first);
           return known == definitions_.channels().end() || !query.wanted || query.wanted(known->second);
         });
}

std::optional<ByteView> IndexedReader::chunk(const ChunkIndex& index) {
  const ChunkContent content = cache_.get(index);
  if (!content.records) report(index, content.fault, content.what);
  return content.records;
}

std::vector<IndexedReader::Ref> IndexedReader::refs_in(const ChunkIndex& index, const MessageQuery& query) {
  std::vector<Ref> refs;
  const std::optional<ByteView> content = chunk(index);
  if (!content) return refs;
  RecordCursor records(*content);
  while (const std::optional<InnerRecord> record = records.next()) {
    if (record->opcode == Opcode::kSchema) {
      if (const auto schema = decode<Schema>(record->content)) definitions_.accept(*schema, index.chunk_start_offset);
    } else if (record->opcode == Opcode::kChannel) {
      if (const auto channel = decode<Channel>(record->content))
        definitions_.accept(*channel, index.chunk_start_offset);
    } else if (const std::optional<Message> head = head_of(*record)) {
      if (head->log_time < index.message_start_time || head->log_time > index.message_end_time)
        report(index, ProblemKind::kIndexMismatch, "a message in it is outside of its times");
      if (definitions_.accept(*head, index.chunk_start_offset) && selects(query, head->channel_id, head->log_time))
        refs.push_back({head->log_time, record->offset});
    }
  }
  if (records.cut()) report(index, ProblemKind::kDamagedRecord, "a record in it is longer than the rest of the chunk");
  std::sort(refs.begin(), refs.end());
  return refs;
}

std::vector<IndexedReader::Ref> IndexedReader::loose_refs(const MessageQuery& query) const {
  std::vector<Ref> refs;
  for (const LooseMessage& loose : summary_.loose_messages)
    if (selects(query, loose.channel_id, loose.log_time)) refs.push_back({loose.log_time, loose.offset});
  std::sort(refs.begin(), refs.end());
  return refs;
}

std::optional<Message> IndexedReader::message(const ChunkIndex* index, std::uint64_t offset) {
  if (index == nullptr) {
    const std::optional<Frame> frame = frame_at(file_, offset);
    return frame ? record_at<Message>(offset, kFrameBytes + frame->length) : std::nullopt;
  }
  const std::optional<ByteView> content = chunk(*index);
  if (!content || offset > content->size()) return std::nullopt;
  const std::optional<InnerRecord> record = RecordCursor(content->subspan(offset)).next();
  return record ? head_of(*record) : std::nullopt;
}

template <class R>
std::optional<R> IndexedReader::record_at(std::uint64_t offset, std::uint64_t length) {
  const std::optional<Frame> frame = frame_at(file_, offset);
  if (!frame || frame->opcode != R::kOpcode || length < kFrameBytes || frame->length != length - kFrameBytes ||
      length > options_.max_record_bytes)
    return std::nullopt;
  const std::optional<ByteView> content = file_.view(frame->content(), frame->length);
  return content ? decode<R>(*content) : std::nullopt;
}

std::optional<Attachment> IndexedReader::attachment(const AttachmentIndex& index) {
  std::optional<Attachment> attachment = record_at<Attachment>(index.offset, index.length);
  const char* what = attachment ? nullptr : "AttachmentIndex: no attachment of this length is there";
  if (attachment && options_.check_crcs && attachment->crc != 0) {
    // The CRC covers everything from the start of the content to the end of the data.
    const std::size_t covered = 32 + attachment->name.size() + attachment->media_type.size() + attachment->data.size();
    const std::optional<ByteView> content = file_.view(index.offset + kFrameBytes, covered);
    if (!content || io::crc32(*content) != attachment->crc) what = "Attachment: its CRC is wrong";
  }
  if (what == nullptr) return attachment;
  problems_.add_repeated({attachment ? ProblemKind::kCrcMismatch : ProblemKind::kIndexMismatch, index.offset, what,
                          "the attachment \"" + index.name + "\" is left out", true});
  return std::nullopt;
}

std::optional<Metadata> IndexedReader::metadata(const MetadataIndex& index) {
  std::optional<Metadata> metadata = record_at<Metadata>(index.offset, index.length);
  if (!metadata)
    problems_.add_repeated({ProblemKind::kIndexMismatch, index.offset,
                            "MetadataIndex: no metadata of this length is there",
                            "the metadata \"" + index.name + "\" is left out", true});
  return metadata;
}

void IndexedReader::report(const ChunkIndex& index, ProblemKind kind, const std::string& what) {
  const bool lost = kind != ProblemKind::kIndexMismatch;
  problems_.add_repeated({kind, index.chunk_start_offset,
                          "Chunk at " + std::to_string(index.chunk_start_offset) + ": " + what,
                          lost ? "its messages are left out" : "it may come out of order", lost});
}

MessageCursor::MessageCursor(IndexedReader& reader, MessageQuery query) : reader_(&reader), query_(std::move(query)) {
  for (const ChunkIndex& index : reader.summary_.chunk_indexes)
    if (reader.may_hold(index, query_)) pending_.push_back(&index);
  std::ranges::stable_sort(pending_, std::ranges::greater{}, &ChunkIndex::message_start_time);
  add({nullptr, reader.loose_refs(query_)});
}

void MessageCursor::add(Run run) {
  if (run.next >= run.refs.size()) return;
  runs_.push_back(std::move(run));
  std::ranges::push_heap(runs_, Later{});
}

void MessageCursor::open_due_chunks() {
  while (!pending_.empty() && (runs_.empty() || pending_.back()->message_start_time <= runs_.front().head().log_time)) {
    const ChunkIndex* const chunk = pending_.back();
    pending_.pop_back();
    add({chunk, reader_->refs_in(*chunk, query_)});
  }
}

const Message* MessageCursor::next() {
  while (true) {
    open_due_chunks();
    if (runs_.empty()) return nullptr;
    std::ranges::pop_heap(runs_, Later{});
    Run run = std::move(runs_.back());
    runs_.pop_back();
    const std::uint64_t offset = run.head().offset;
    ++run.next;
    const ChunkIndex* const chunk = run.chunk;
    add(std::move(run));
    if (const std::optional<Message> found = reader_->message(chunk, offset)) {
      message_ = *found;
      return &message_;
    }
  }
}

}  // namespace rtd::mcap
