// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <vector>

#include "services/filter/core/tracks/detection_batch.hpp"

namespace rtd::filter {

/// Pairs the detector's batches with frames by stamp. Filled by a bus thread, read by the worker. Thread-safe, bounded:
/// of more than 64 batches the first to arrive is dropped, so that stamps of the far future cannot fill it for good.
class DetectionInbox {
 public:
  void put(DetectionBatch batch);
  /// Waits for the batch of exactly this stamp, until it has arrived, `give_up()` returns true (called every 50 ms) or
  /// the inbox is closed. True when it is here.
  bool wait_for(std::int64_t stamp_ns, const std::function<bool()>& give_up);
  /// All batches that are not newer than `stamp_ns`, by stamp; each is handed out once.
  std::vector<DetectionBatch> take_until(std::int64_t stamp_ns);
  /// Time went backwards: what is here belongs to other frames.
  void clear();
  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::map<std::int64_t, std::vector<vision::Detection>> by_stamp_;
  std::deque<std::int64_t> arrivals_;  ///< stamps in order of arrival, including those handed out
  bool closed_ = false;
};

}  // namespace rtd::filter
