// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/mcap/writer.hpp"
#include "services/recorder/core/message_queue.hpp"
#include "services/recorder/core/split_policy.hpp"
#include "services/recorder/core/sync_thread.hpp"
#include "services/recorder/core/topic_book.hpp"

namespace rtd::recorder {

struct RecordingOptions {
  mcap::Compression compression = mcap::Compression::kNone;
  std::uint64_t chunk_bytes = 1024 * 1024;  ///< a chunk is ended when it has so many
  std::int64_t chunk_age_ns = 100'000'000;  ///< or when its first message has waited that long
  SplitPolicy split;
};

/// One file of a recording.
struct FileSummary {
  std::uint64_t bytes = 0, messages = 0;
  std::uint64_t first_ns = 0, last_ns = 0;  ///< reception of its first and last message
};

/// Puts messages into MCAP files, chunk by chunk, and has each ended chunk made durable. Knows no clock: "now" is any
/// steadily growing time. For one thread. IoError passes through: what was written before stays whole.
class Recording {
 public:
  using OpenSink = std::function<std::shared_ptr<mcap::ByteSink>(std::size_t number)>;

  Recording(RecordingOptions options, OpenSink open_sink, TopicBook& book, SyncThread& sync);

  void write(const QueuedMessage& message, std::int64_t now_ns);
  /// Ends a chunk that has waited long enough.
  void tick(std::int64_t now_ns);
  /// Ends the file: channels of topics that had no message, metadata, summary.
  void finish(const std::vector<mcap::Metadata>& metadata);

  std::vector<FileSummary> files() const;
  std::uint64_t bytes() const { return bytes_before_ + file_.bytes; }

 private:
  mcap::ChannelId channel(std::size_t topic);
  void end_chunk();
  void begin_next_file();
  void update_file();

  const RecordingOptions options_;
  const OpenSink open_sink_;
  TopicBook& book_;
  SyncThread& sync_;
  std::shared_ptr<mcap::ByteSink> sink_;
  mcap::Writer writer_;
  std::map<std::size_t, mcap::ChannelId> channels_;
  std::map<std::string, mcap::SchemaId> schemas_;
  std::vector<std::uint64_t> messages_;  ///< by topic, with the open chunk
  std::vector<FileSummary> ended_files_;
  FileSummary file_;
  std::uint64_t bytes_before_ = 0;  ///< of ended files
  std::optional<std::int64_t> chunk_begun_ns_;
};

}  // namespace rtd::recorder
