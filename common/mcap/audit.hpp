// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>

#include "common/mcap/problem.hpp"
#include "common/mcap/records.hpp"

namespace rtd::mcap {

/// The schemas and channels of a file as they come, checked against each other.
class Definitions {
 public:
  explicit Definitions(Problems& problems) : problems_(problems) {}

  /// False, and a problem at `offset`: the record must not be used.
  bool accept(const Schema& schema, std::uint64_t offset);
  bool accept(const Channel& channel, std::uint64_t offset);
  bool accept(const Message& message, std::uint64_t offset);

  const std::map<SchemaId, Schema>& schemas() const { return schemas_; }
  const std::map<ChannelId, Channel>& channels() const { return channels_; }

 private:
  template <class Id, class R>
  bool keep(std::map<Id, R>& known, const R& record, const char* kind, std::uint64_t offset);

  Problems& problems_;
  std::map<SchemaId, Schema> schemas_;
  std::map<ChannelId, Channel> channels_;
  std::uint64_t described_bytes_ = 0;  ///< texts of the types of all channels
};

/// Compares the indexes and statistics of a file with the records that were seen. Each check_... returns what differs.
class IndexAudit {
 public:
  void begin_chunk(std::uint64_t offset, std::uint64_t length, const Chunk& chunk);
  void lose_content();                        ///< of the last chunk: its message indexes are then not checked
  void lose_chunk() { open_chunk_.reset(); }  ///< what follows belongs to a chunk that was not seen
  void message() { ++message_count_; }
  void message_in_chunk(const Message& message, std::uint64_t offset_in_chunk);
  /// What differs between the times in the head of the chunk and those of its messages.
  std::optional<std::string> end_chunk();
  void attachment(std::uint64_t offset, std::uint64_t length) { attachments_.emplace(offset, length); }
  void metadata(std::uint64_t offset, std::uint64_t length) { metadata_.emplace(offset, length); }
  void summary_record(Opcode opcode, std::uint64_t offset, std::uint64_t length);

  std::optional<std::string> check(std::uint64_t offset, std::uint64_t length, const MessageIndex& index);
  std::optional<std::string> check(const ChunkIndex& index) const;
  std::optional<std::string> check(const AttachmentIndex& index) const;
  std::optional<std::string> check(const MetadataIndex& index) const;
  std::optional<std::string> check(const SummaryOffset& group) const;
  std::optional<std::string> check(const Statistics& statistics) const;
  std::uint64_t message_count() const { return message_count_; }

 private:
  struct SeenMessage {
    std::uint64_t offset = 0;
    Timestamp log_time = 0;
    ChannelId channel_id = 0;
  };
  struct SeenGroup {
    std::uint64_t start = 0, length = 0;
  };

  std::map<std::uint64_t, ChunkIndex> chunks_;  ///< as their index should be, by offset
  std::optional<std::uint64_t> open_chunk_;     ///< offset of the last one
  std::vector<SeenMessage> messages_;           ///< of that one, by offset
  std::map<ChannelId, std::uint64_t> counts_;   ///< of these, by channel
  std::set<std::pair<std::uint64_t, std::uint64_t>> attachments_, metadata_;
  std::map<Opcode, SeenGroup> groups_;
  std::uint64_t message_count_ = 0;
};

}  // namespace rtd::mcap
