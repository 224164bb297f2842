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

#include "common/io/byte_sink.hpp"

namespace rtd::recorder {

/// What is certain to be on disk.
struct Acknowledged {
  std::uint64_t bytes = 0;              ///< of all files of the recording
  std::vector<std::uint64_t> messages;  ///< by topic
};

/// Makes written data survive a power cut. It has a thread of its own because fdatasync(2) may take long: the durable
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

}  // namespace rtd::recorder
