// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "common/msg/features.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"
#include "services/evaluation/record/run_record.hpp"
#include "services/launcher/core/run/live_status.hpp"

namespace rtd::launcher {

/// Joins the message streams of a run into its record. Messages may be missing, doubled or out of order: the first
/// message of a frame counts, because a repeated one is an answer to a repeated question. Not thread-safe.
class RecordBuilder {
 public:
  void add(const msg::FeatureFrame& features);
  void add(const msg::TrackingResult& result);
  /// Counters of a service. Those named *dropped*, *late*, *skipped*, *lost* or *refused* become RunRecord::drops; they
  /// go on counting when the service is restarted.
  void add(const msg::ServiceStatus& status);

  /// Frames that the source delivered: the camera's own count, else what was seen of it.
  std::uint64_t frames_in() const;
  bool tracked_any() const;  ///< at least one frame got a pose
  LiveStatus live() const;
  /// The newest message of a service that is degraded; told once each time it changes.
  std::optional<std::string> take_notice();

  /// "filter (pid 42), slam (pid 43)": every service heard that has not said goodbye; a recorder only
  /// listens and does not count, nor does a detector of another host if so asked. Empty when there is none.
  std::string services_heard(bool without_detector = false) const;

  /// Writes frames, frames_in, frames_dropped and drops.
  void fill(eval::RunRecord& record) const;

 private:
  struct Counter {
    double current = 0, before_restart = 0;
    double total() const { return current + before_restart; }
  };
  struct Service {
    std::int64_t pid = 0;
    msg::ServiceState state = msg::ServiceState::kStarting;
    std::string message;
    std::map<std::string, Counter> counters;
  };

  std::map<std::string, double> drops() const;
  std::vector<eval::HostClock> clocks() const;
  void note_troubles(const msg::ServiceStatus& status);
  double camera_counter(const std::string& name) const;

  struct Frame {
    eval::FrameRecord record;
    bool has_features = false, has_result = false;
  };
  std::map<std::uint64_t, Frame> frames_;  ///< by seq
  std::map<std::string, Service> services_;
  std::deque<std::string> notices_;
  std::map<std::string, std::string> troubles_;  ///< told: by the service or the counter concerned
  std::deque<msg::TrackingResult> recent_;
  std::uint64_t end_of_seen_ = 0;  ///< highest seq seen + 1
  bool tracked_any_ = false;
};

}  // namespace rtd::launcher
