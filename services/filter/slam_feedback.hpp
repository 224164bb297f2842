// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "common/msg/tracking.hpp"

namespace rtd::filter {

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
