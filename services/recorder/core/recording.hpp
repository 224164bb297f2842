// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/io/byte_sink.hpp"
#include "common/mcap/writer.hpp"
#include "services/recorder/core/message_queue.hpp"
#include "services/recorder/core/output_files.hpp"
#include "services/recorder/core/topic_registry.hpp"

namespace rtd::recorder {

/// What is certain to be on disk.
struct Acknowledged {
  std::uint64_t bytes = 0;              ///< of all files of the recording
  std::vector<std::uint64_t> messages;  ///< by topic
};

/// Makes written data survive a power cut. It has its own thread because fdatasync(2) may take long: the durable
/// watermark follows the writing. Thread-safe.
class SyncThread {
 public:
  /// At least `pause` passes between two syncs, so that the disk is not kept busy with its journal.
  explicit SyncThread(std::chrono::milliseconds pause);
  ~SyncThread() { finish(); }
  SyncThread(const SyncThread&) = delete;
  SyncThread& operator=(const SyncThread&) = delete;

  /// The sink now contains `written` in complete records. It is kept alive until that is durable.
  void put(std::shared_ptr<io::ByteSink> sink, Acknowledged written);
  Acknowledged acknowledged() const;
  /// Why a sync failed; empty: none did. After a failure nothing more is acknowledged.
  std::string failure() const;
  /// Syncs the rest and ends.
  void finish();

 private:
  struct Mark {
    std::shared_ptr<io::ByteSink> sink;
    Acknowledged written;
  };
  void loop();
  void sync(const std::deque<Mark>& marks);

  const std::chrono::milliseconds pause_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Mark> marks_;
  Acknowledged acknowledged_;
  std::string failure_;
  bool ended_ = false;
  std::thread thread_;
};

struct RecordingOptions {
  mcap::Compression compression = mcap::Compression::kNone;
  std::uint64_t chunk_bytes = 1024 * 1024;  ///< a chunk ends at this size
  std::int64_t chunk_age_ns = 100'000'000;  ///< or when its first message has waited this long
  SplitPolicy split;
};

/// One file of a recording.
struct FileSummary {
  std::uint64_t bytes = 0, messages = 0;
  std::uint64_t first_ns = 0, last_ns = 0;  ///< reception of its first and last message
};

/// Writes messages to MCAP files, chunk by chunk, and has each finished chunk made durable. "Now" is any steadily
/// growing time. For one thread. IoError passes through: what was written before stays intact.
class Recording {
 public:
  using OpenSink = std::function<std::shared_ptr<io::ByteSink>(std::size_t number)>;

  Recording(RecordingOptions options, OpenSink open_sink, TopicRegistry& book, SyncThread& sync);

  void write(const QueuedMessage& message, std::int64_t now_ns);
  /// Ends a chunk that has waited long enough.
  void tick(std::int64_t now_ns);
  /// Ends the file: channels of topics that had no message, metadata, summary.
  void finish(const std::vector<mcap::Metadata>& metadata);

  std::vector<FileSummary> files() const;
  std::uint64_t bytes() const { return bytes_before_ + file_.bytes; }

 private:
  mcap::ChannelId channel(std::size_t topic);
  /// When it was received, but not before the message of its topic that was delivered before it: the next ones may have
  /// been received while a lost one was sent again, and MCAP files are read in the order of these times.
  std::uint64_t log_time(const QueuedMessage& message);
  void end_chunk();
  void begin_next_file();

  const RecordingOptions options_;
  const OpenSink open_sink_;
  TopicRegistry& book_;
  SyncThread& sync_;
  std::shared_ptr<io::ByteSink> sink_;
  mcap::Writer writer_;
  std::map<std::size_t, mcap::ChannelId> channels_;
  std::vector<std::uint64_t> messages_;   ///< by topic, with the open chunk
  std::vector<std::uint64_t> logged_ns_;  ///< by topic, of its last message
  std::vector<FileSummary> ended_files_;
  FileSummary file_;
  std::uint64_t bytes_before_ = 0;  ///< of ended files
  std::optional<std::int64_t> chunk_begun_ns_;
};

/// The text of rosbag2's metadata.yaml, version 5, which every version since ROS 2 Humble reads. `names` are the
/// file names, relative to it.
std::string bag_metadata_text(const std::vector<std::string>& names, const std::vector<FileSummary>& files,
                              const std::vector<RecordedTopic>& topics);

}  // namespace rtd::recorder
