// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/mcap/byte_sink.hpp"

namespace rtd::recorder {

/// What is on disk for certain.
struct Acknowledged {
  std::uint64_t bytes = 0;              ///< of all files of the recording
  std::vector<std::uint64_t> messages;  ///< by topic
};

/// Makes what was written survive a power cut, in a thread of its own, for fdatasync(2) may take long: the durable
/// watermark follows the writing. Thread-safe.
class SyncThread {
 public:
  /// Between two syncs there is at least that pause, so that a disk is not kept busy with its journal.
  explicit SyncThread(std::chrono::milliseconds pause);
  ~SyncThread() { finish(); }
  SyncThread(const SyncThread&) = delete;
  SyncThread& operator=(const SyncThread&) = delete;

  /// The sink now ends with whole records that hold this. It is kept until that is durable.
  void put(std::shared_ptr<mcap::ByteSink> sink, Acknowledged written);
  Acknowledged acknowledged() const;
  /// Why a sync failed; empty: none did. Then nothing more is acknowledged.
  std::string failure() const;
  /// Syncs what is left and ends.
  void finish();

 private:
  struct Mark {
    std::shared_ptr<mcap::ByteSink> sink;
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

}  // namespace rtd::recorder
