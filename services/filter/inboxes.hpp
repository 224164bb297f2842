// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "common/msg/tracking.hpp"
#include "services/filter/core/boxes/box_tracks.hpp"

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

/// What slam has sent since the last call, in slam's own order.
struct SlamUpdate {
  std::vector<msg::KeyframeEvent> events;    ///< by event_index
  std::vector<msg::TrackingResult> results;  ///< by seq
  bool complete = true;                      ///< what the caller waited for has arrived
};

/// Collects results and keyframe events, which arrive on two topics and so in no common order. Thread-safe, bounded.
class SlamFeedback {
 public:
  void put(const msg::TrackingResult& result);
  void put(const msg::KeyframeEvent& event);
  /// Everything that is here.
  SlamUpdate take();
  /// Waits for the result of frame `seq` and every event before it, then takes everything.
  SlamUpdate take_after(std::uint64_t seq, std::chrono::milliseconds timeout);
  /// Waits for the same, or the end, and takes nothing; false: it has not come within the timeout.
  bool wait_for(std::uint64_t seq, std::chrono::milliseconds timeout);
  void close();

 private:
  bool complete(std::uint64_t seq) const;
  SlamUpdate take_locked(bool complete);

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::map<std::uint64_t, msg::TrackingResult> results_;
  std::map<std::uint64_t, msg::KeyframeEvent> events_;
  std::uint64_t events_received_ = 0;  ///< events 0 .. n-1 have arrived or never will
  std::optional<msg::TrackingResult> newest_;
  bool closed_ = false;
};

}  // namespace rtd::filter
