// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "common/mcap/indexed_reader.hpp"

namespace rtd::replay {

/// A message of a recording with its bytes.
struct PlayedMessage {
  mcap::ChannelId channel = 0;
  std::int64_t log_ns = 0, publish_ns = 0;
  std::shared_ptr<const std::vector<std::byte>> cdr;
};

struct FeedOptions {
  std::uint64_t read_ahead_bytes = 64 * 1024 * 1024;  ///< at least one message is kept, however long
  std::int64_t start_ns = 0, end_ns = 0;              ///< first and last log_time
  std::function<bool(const mcap::Channel&)> wanted;
};

/// Reads the messages of a recording in order of time, in its own thread, ahead of the one thread that plays them.
class MessageFeed {
 public:
  /// Only the feed may use `reader` while the feed exists.
  MessageFeed(mcap::IndexedReader& reader, FeedOptions options);
  ~MessageFeed();
  MessageFeed(const MessageFeed&) = delete;
  MessageFeed& operator=(const MessageFeed&) = delete;

  /// The next message; waits for it. Empty at the end and after close().
  std::optional<PlayedMessage> next();
  /// Continues with the first message at or after this time.
  void seek(std::int64_t log_ns);
  /// Ends the reading and wakes next(); any thread.
  void close();

 private:
  void read_all();
  void read_from(std::int64_t log_ns, std::uint64_t generation);
  bool put(PlayedMessage message, std::uint64_t generation);
  std::optional<std::int64_t> wait_for_seek(std::uint64_t& generation);

  mcap::IndexedReader& reader_;
  const FeedOptions options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<PlayedMessage> messages_;
  std::uint64_t bytes_ = 0;
  std::uint64_t generation_ = 1;  ///< counts the seeks: what was read for an earlier one is dropped
  std::int64_t seek_ns_ = 0;
  bool at_end_ = false, closed_ = false;
  std::thread thread_;
};

}  // namespace rtd::replay
