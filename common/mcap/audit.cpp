// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/audit.hpp"

#include <algorithm>

namespace rtd::mcap {

template <class Id, class R>
bool Definitions::keep(std::map<Id, R>& known, const R& record, const char* kind, std::uint64_t offset) {
  const auto [entry, added] = known.try_emplace(record.id, record);
  if (added || entry->second == record) return true;
  problems_.add_repeated({ProblemKind::kConflictingDefinition, offset,
                          std::string(kind) + ' ' + std::to_string(record.id) + " is defined twice, differently",
                          "the first definition counts"});
  return false;
}

bool Definitions::accept(const Schema& schema, std::uint64_t offset) {
  if (schema.id != 0) return keep(schemas_, schema, "Schema", offset);
  problems_.add_repeated({ProblemKind::kDamagedRecord, offset, "Schema: the id 0 means \"no schema\"",
                          "it is ignored, as the format asks"});
  return false;
}

bool Definitions::accept(const Channel& channel, std::uint64_t offset) {
  constexpr std::uint64_t kMostDescribed = 16 << 20;  // who reads a type reads its text for each channel
  const auto schema = schemas_.find(channel.schema_id);
  if (schema != schemas_.end() && !channels_.contains(channel.id)) {
    const std::uint64_t bytes = schema->second.data.size();
    if (bytes > kMostDescribed - described_bytes_) {
      problems_.add_repeated({ProblemKind::kTooLarge, offset,
                              "Channel: the texts of the types of all channels are above 16 MiB",
                              "it is left out, with its messages", true});
      return false;
    }
    described_bytes_ += bytes;
  }
  if (channel.schema_id != 0 && schema == schemas_.end())
    problems_.add_repeated({ProblemKind::kMissingSchema, offset,
                            "Channel \"" + channel.topic + "\": its schema " + std::to_string(channel.schema_id) +
                                " is not in the file before it",
                            "its messages are delivered, but cannot be decoded without knowing their type"});
  return keep(channels_, channel, "Channel", offset);
}

bool Definitions::accept(const Message& message, std::uint64_t offset) {
  if (channels_.contains(message.channel_id)) return true;
  problems_.add_repeated(
      {ProblemKind::kMissingChannel, offset,
       "Message: its channel " + std::to_string(message.channel_id) + " is not in the file before it",
       "the messages of this channel are left out: their topic is not known", true});
  return false;
}

namespace {

using Found = std::optional<std::string>;

Found differs(const std::string& field, std::uint64_t says, std::uint64_t is) {
  if (says == is) return std::nullopt;
  return field + " is " + std::to_string(is) + ", the record says " + std::to_string(says);
}

Found first_of(std::initializer_list<Found> found) {
  for (const Found& one : found)
    if (one) return one;
  return std::nullopt;
}

Found check_place(const std::set<std::pair<std::uint64_t, std::uint64_t>>& seen, std::uint64_t offset,
                  std::uint64_t length, const std::string& kind) {
  if (seen.contains({offset, length})) return std::nullopt;
  return "no " + kind + " of " + std::to_string(length) + " bytes is at offset " + std::to_string(offset);
}

}  // namespace

void IndexAudit::begin_chunk(std::uint64_t offset, std::uint64_t length, const Chunk& chunk) {
  chunks_[offset] = index_of(chunk, offset, length);
  open_chunk_ = offset;
  lose_content();
}

void IndexAudit::message_in_chunk(const Message& message, std::uint64_t offset_in_chunk) {
  ++message_count_;
  ++counts_[message.channel_id];
  messages_.push_back({offset_in_chunk, message.log_time, message.channel_id});
}

void IndexAudit::lose_content() {
  messages_.clear();
  counts_.clear();
}

Found IndexAudit::end_chunk() {
  if (!open_chunk_ || messages_.empty()) return std::nullopt;
  const ChunkIndex& index = chunks_.at(*open_chunk_);
  const auto [first, last] = std::ranges::minmax_element(messages_, {}, &SeenMessage::log_time);
  return first_of({differs("the first log_time in it", index.message_start_time, first->log_time),
                   differs("the last log_time in it", index.message_end_time, last->log_time)});
}

void IndexAudit::summary_record(Opcode opcode, std::uint64_t offset, std::uint64_t length) {
  const auto [group, added] = groups_.try_emplace(opcode, SeenGroup{offset, 0});
  group->second.length += length;
}

Found IndexAudit::check(std::uint64_t offset, std::uint64_t length, const MessageIndex& index) {
  if (!open_chunk_) return std::nullopt;
  ChunkIndex& chunk = chunks_.at(*open_chunk_);
  chunk.message_index_offsets.emplace(index.channel_id, offset);
  chunk.message_index_length += length;
  if (messages_.empty()) return std::nullopt;
  for (const auto& [log_time, in_chunk] : index.records) {
    const auto seen = std::ranges::lower_bound(messages_, in_chunk, {}, &SeenMessage::offset);
    if (seen == messages_.end() || seen->offset != in_chunk || seen->log_time != log_time ||
        seen->channel_id != index.channel_id)
      return "no message of channel " + std::to_string(index.channel_id) + " and log_time " + std::to_string(log_time) +
             " is at " + std::to_string(in_chunk) + " in the chunk";
  }
  return differs("the number of messages of its channel", index.records.size(), counts_[index.channel_id]);
}

Found IndexAudit::check(const ChunkIndex& index) const {
  const auto seen = chunks_.find(index.chunk_start_offset);
  if (seen == chunks_.end()) return "no chunk is at offset " + std::to_string(index.chunk_start_offset);
  const ChunkIndex& chunk = seen->second;
  if (chunk.compression != index.compression)
    return "the compression is \"" + chunk.compression + "\", the record says \"" + index.compression + '"';
  if (!index.message_index_offsets.empty() && chunk.message_index_offsets != index.message_index_offsets)
    return "the offsets of the message indexes are others";
  return first_of({differs("the length of the chunk", index.chunk_length, chunk.chunk_length),
                   differs("message_start_time", index.message_start_time, chunk.message_start_time),
                   differs("message_end_time", index.message_end_time, chunk.message_end_time),
                   differs("the length of the message indexes", index.message_index_length, chunk.message_index_length),
                   differs("the compressed size", index.compressed_size, chunk.compressed_size),
                   differs("the uncompressed size", index.uncompressed_size, chunk.uncompressed_size)});
}

Found IndexAudit::check(const AttachmentIndex& index) const {
  return check_place(attachments_, index.offset, index.length, "attachment");
}

Found IndexAudit::check(const MetadataIndex& index) const {
  return check_place(metadata_, index.offset, index.length, "metadata");
}

Found IndexAudit::check(const SummaryOffset& group) const {
  const auto seen = groups_.find(group.group_opcode);
  // Some writers list the groups that they left empty, too.
  if (seen == groups_.end() && group.group_length == 0) return std::nullopt;
  if (seen == groups_.end()) return "the summary has no such group";
  return first_of({differs("the start of the group", group.group_start, seen->second.start),
                   differs("the length of the group", group.group_length, seen->second.length)});
}

Found IndexAudit::check(const Statistics& statistics) const {
  return first_of({differs("the number of messages", statistics.message_count, message_count_),
                   differs("the number of chunks", statistics.chunk_count, chunks_.size()),
                   differs("the number of attachments", statistics.attachment_count, attachments_.size()),
                   differs("the number of metadata records", statistics.metadata_count, metadata_.size())});
}

}  // namespace rtd::mcap
