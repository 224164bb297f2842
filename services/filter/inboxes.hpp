// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "common/msg/tracking.hpp"
#include "services/filter/core/boxes/box_tracks.hpp"

namespace rtd::filter {

/// Values by stamp, bounded: of more than 64 the first to arrive is dropped, so that stamps of the far future cannot
/// fill it for good. A later value of a stamp replaces the earlier one.
template <class T>
class ByStamp {
 public:
  void put(std::int64_t stamp_ns, T value) {
    arrivals_.push_back(stamp_ns);
    values_[stamp_ns] = std::move(value);
    while (arrivals_.size() > kMaxStamps) {
      const std::int64_t first = arrivals_.front();
      arrivals_.pop_front();
      if (std::find(arrivals_.begin(), arrivals_.end(), first) == arrivals_.end()) values_.erase(first);
    }
  }
  bool has(std::int64_t stamp_ns) const { return values_.contains(stamp_ns); }
  std::optional<T> take(std::int64_t stamp_ns) {
    auto node = values_.extract(stamp_ns);
    return node ? std::optional(std::move(node.mapped())) : std::nullopt;
  }
  /// All that are not newer, by stamp.
  std::map<std::int64_t, T> take_until(std::int64_t stamp_ns) {
    std::map<std::int64_t, T> taken;
    while (!values_.empty() && values_.begin()->first <= stamp_ns) taken.insert(values_.extract(values_.begin()));
    return taken;
  }
  void clear() {
    values_.clear();
    arrivals_.clear();
  }

 private:
  static constexpr std::size_t kMaxStamps = 64;
  std::map<std::int64_t, T> values_;
  std::deque<std::int64_t> arrivals_;  ///< stamps in order of arrival, including those handed out
};

/// Pairs the detector's batches with frames by stamp, and the masks of persons with the batches. Filled by bus threads,
/// read by the worker. Thread-safe, bounded (ByStamp).
class DetectionInbox {
 public:
  using GiveUp = std::function<bool()>;

  /// `in_message`: detections that the message had; masks count all of them, so that a batch with fewer gets no masks.
  void put(DetectionBatch batch, std::size_t in_message);
  void put(DetectionBatch batch);
  void put_masks(std::int64_t stamp_ns, vision::PersonMasks masks);
  /// Waits for the batch of exactly this stamp, until it has arrived, `give_up()` returns true (called every 50 ms) or
  /// the inbox is closed. True when it is here.
  bool wait_for(std::int64_t stamp_ns, const GiveUp& give_up);
  /// The same for its masks; does not wait any longer when those of a later stamp have arrived, nor after a wait in
  /// vain until masks arrive again.
  bool wait_for_masks(std::int64_t stamp_ns, const GiveUp& give_up);
  /// All batches that are not newer than `stamp_ns`, by stamp, with the masks that are here; each is handed out once.
  std::vector<DetectionBatch> take_until(std::int64_t stamp_ns);
  /// Time went backwards: what is here belongs to other frames.
  void clear();
  void close();

 private:
  struct Boxes {
    std::vector<vision::Detection> detections;
    std::size_t in_message = 0;
  };
  bool wait(const std::function<bool()>& done, const GiveUp& give_up);

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  ByStamp<Boxes> boxes_;
  ByStamp<vision::PersonMasks> masks_;
  std::int64_t newest_masks_ns_ = std::numeric_limits<std::int64_t>::min();
  bool masks_silent_ = false;  ///< a wait for them was in vain
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
