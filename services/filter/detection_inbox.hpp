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

#include "common/msg/ros.hpp"
#include "services/filter/core/tracks/detection_batch.hpp"

namespace rtd::filter {

/// Pairs the detector's answers with frames by stamp. Filled by a bus thread, read by the worker. Thread-safe, bounded:
/// of more than 64 the first that came goes, so that stamps of the far future cannot fill it for good.
class DetectionInbox {
 public:
  void put(DetectorAnswer answer);
  /// Waits for the answer of exactly this stamp, until it has come, `give_up()` says so (asked every 50 ms) or the
  /// inbox is closed. True when it is here.
  bool wait_for(std::int64_t stamp_ns, const std::function<bool()>& give_up);
  /// All answers that are not newer than `stamp_ns`, by stamp; they are handed out once.
  std::vector<DetectorAnswer> take_until(std::int64_t stamp_ns);
  /// Time went backwards: what is here belongs to another story.
  void clear();
  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::map<std::int64_t, std::vector<vision::Detection>> by_stamp_;
  std::deque<std::int64_t> arrivals_;  ///< stamps in the order in which they came, also of what was handed out
  bool closed_ = false;
};

/// Best hypothesis of every box; boxes without one, with numbers that are not finite or without area are left out,
/// of more than 300 the best are kept.
DetectorAnswer from_message(const msg::Detection2DArray& message);

}  // namespace rtd::filter
