// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>

#include "common/mcap/audit.hpp"
#include "common/mcap/chunk_content.hpp"
#include "common/mcap/summary.hpp"

namespace rtd::mcap {

struct MessageQuery {
  Timestamp start = 0;                                    ///< first log_time
  Timestamp end = std::numeric_limits<Timestamp>::max();  ///< last log_time
  std::function<bool(const Channel&)> wanted;             ///< empty: all channels
};

class MessageCursor;

/// Finds messages by time and topic through the summary and opens only the chunks that it needs. Where the summary is
/// missing, damaged or wrong about where chunks are, the file is read once from the start instead (problems() says so).
/// Reading through the index does not see damage where it does not read: StreamReader checks everything.
/// Memory: the summary, ReaderOptions::cache_bytes and 16 bytes per message of the chunks that overlap in time.
/// For one thread.
class IndexedReader {
 public:
  /// `source` must outlive the reader. Never throws for what is in the file.
  explicit IndexedReader(const io::ByteSource& source, ReaderOptions options = {});
  IndexedReader(const IndexedReader&) = delete;
  IndexedReader& operator=(const IndexedReader&) = delete;

  const Summary& summary() const { return summary_; }
  /// Grows while messages are read.
  const Problems& problems() const { return problems_; }

  /// The messages of the query by log_time, equal times in file order. The cursor must not outlive the reader.
  MessageCursor messages(MessageQuery query = {});
  /// Empty, with a problem, when it is damaged. The view lives until the next use of the reader or a cursor.
  std::optional<Attachment> attachment(const AttachmentIndex& index);
  std::optional<Metadata> metadata(const MetadataIndex& index);

 private:
  friend class MessageCursor;
  struct Ref {
    Timestamp log_time = 0;
    std::uint64_t offset = 0;  ///< of the record: in the uncompressed chunk, or in the file for a loose message
    bool operator<(const Ref& other) const {
      return log_time != other.log_time ? log_time < other.log_time : offset < other.offset;
    }
  };

  std::vector<Ref> refs_in(const ChunkIndex& index, const MessageQuery& query);
  std::vector<Ref> loose_refs(const MessageQuery& query) const;
  bool selects(const MessageQuery& query, ChannelId channel, Timestamp log_time) const;
  bool may_hold(const ChunkIndex& index, const MessageQuery& query) const;
  std::optional<ByteView> chunk(const ChunkIndex& index);
  /// `index` null: a loose message.
  std::optional<Message> message(const ChunkIndex* index, std::uint64_t offset);
  template <class R>
  std::optional<R> record_at(std::uint64_t offset, std::uint64_t length);
  void report(const ChunkIndex& index, ProblemKind kind, const std::string& what);

  ReaderOptions options_;
  Problems problems_;
  SourceWindow file_;
  Summary summary_;
  Definitions definitions_;
  ChunkCache cache_;
};

/// Goes through the messages of one query.
class MessageCursor {
 public:
  /// The next message, null at the end. Lives until the next use of this cursor or its reader.
  const Message* next();
  /// Of the last message.
  const Channel& channel() const { return reader_->definitions_.channels().at(message_.channel_id); }

 private:
  friend class IndexedReader;
  /// The wanted messages of one chunk, or the loose ones (chunk null), by time.
  struct Run {
    const ChunkIndex* chunk = nullptr;
    std::vector<IndexedReader::Ref> refs;
    std::size_t next = 0;

    const IndexedReader::Ref& head() const { return refs[next]; }
    std::uint64_t file_offset() const { return chunk != nullptr ? chunk->chunk_start_offset : head().offset; }
  };
  struct Later {
    bool operator()(const Run& a, const Run& b) const {
      if (a.head().log_time != b.head().log_time) return a.head().log_time > b.head().log_time;
      return a.file_offset() > b.file_offset();
    }
  };

  MessageCursor(IndexedReader& reader, MessageQuery query);
  void open_due_chunks();
  void add(Run run);

  IndexedReader* reader_;
  MessageQuery query_;
  std::vector<const ChunkIndex*> pending_;  ///< the next one last
  std::vector<Run> runs_;                   ///< a heap: the earliest first
  Message message_;
};

}  // namespace rtd::mcap
