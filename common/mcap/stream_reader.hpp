// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/io/unpacked.hpp"
#include "common/mcap/audit.hpp"
#include "common/mcap/chunk_content.hpp"
#include "common/mcap/framing.hpp"

namespace rtd::mcap {

/// Where the last record came from.
struct Location {
  Frame record;  ///< the record in the file: for one inside a chunk, the chunk
  bool in_chunk = false;
  std::uint64_t offset_in_chunk = 0;  ///< uncompressed
};

/// Reads all records of a file in file order, opens the chunks, and checks everything that can be checked: lengths, all
/// CRCs, definitions before use, indexes and statistics against what the file holds. Tolerant: whatever the bytes are,
/// it delivers each record that is whole, continues behind the damage and lists what was wrong. A chunk or attachment
/// whose CRC is wrong is left out as a whole. Memory: one record or chunk, and an entry for each index entry. For one
/// thread.
class StreamReader {
 public:
  /// `source` must outlive the reader.
  explicit StreamReader(const io::ByteSource& source, ReaderOptions options = {});
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;

  /// Definitions to fall back on where those of the file are lost, e.g. from its summary. Before the first next().
  void assume(const std::map<SchemaId, Schema>& schemas, const std::map<ChannelId, Channel>& channels);

  /// The next record, null at the end. It and its views live until the next call. A Chunk is followed by its content;
  /// messages without a known channel and contradicting definitions are left out.
  const Record* next();
  const Location& location() const { return location_; }

  const std::map<SchemaId, Schema>& schemas() const { return definitions_.schemas(); }
  const std::map<ChannelId, Channel>& channels() const { return definitions_.channels(); }
  /// Complete once next() has returned null.
  const Problems& problems() const { return problems_; }
  std::uint64_t bytes_read() const { return position_; }  ///< for a progress bar

 private:
  enum class Step { kRecord, kNothing, kEnd };

  bool begin();
  Step step();
  Step read(const Frame& frame);
  template <class... R>
  Step dispatch(const Frame& frame, ByteView content, const std::variant<R...>& types);
  template <class R>
  Step read_as(const Frame& frame, ByteView content);
  Step skip_unknown(const Frame& frame);
  Step leave_out(const Frame& frame, ProblemKind kind, const std::string& what);
  Step damaged(const Frame& frame, const std::string& what);
  Step cut(const Frame& frame);
  bool salvage(const Frame& frame);
  void extend_crc(std::uint64_t end);

  // Each checks one record in its place; false: it must not be delivered.
  template <class R>
  bool check(const Frame& frame, ByteView content, const R& record);
  bool check_chunk(const Frame& frame, const Chunk& chunk);
  void check_length(const Frame& frame, std::uint64_t fields_end);
  bool check_loose_message(const Frame& frame, ByteView content, const Message& message);
  void check_statistics(const Frame& frame, const Statistics& statistics);
  bool check_attachment(const Frame& frame, ByteView content, const Attachment& attachment);
  void check_data_end(const Frame& frame, const DataEnd& end);
  void check_footer(const Frame& frame, const Footer& footer);
  void check_closing_magic(const Frame& frame);
  void check_index(const Frame& frame, const std::optional<std::string>& difference);

  const Record* next_in_chunk();
  template <class R>
  bool take_inner(const InnerRecord& inner);
  void end_chunk();
  void report(ProblemKind kind, std::uint64_t offset, std::string what, std::string consequence, bool lost = false);

  ReaderOptions options_;
  Problems problems_;
  SourceWindow file_;
  Definitions definitions_;
  IndexAudit audit_;
  Record record_;
  Location location_;
  std::uint64_t position_ = 0;
  std::optional<RecordCursor> chunk_;
  bool salvaging_ = false;  ///< chunk_ is what is left of a cut one
  io::UnpackLimit unpack_limit_;
  Decompressor decompress_;
  Buffer uncompressed_;
  std::uint32_t crc_ = 0;  ///< of [0, crc_end_)
  std::uint64_t crc_end_ = 0;
  std::uint64_t data_end_ = 0;  ///< where the DataEnd record ends; 0: not seen
  bool started_ = false, chunked_ = false, at_end_ = false;
};

}  // namespace rtd::mcap
