// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace rtd::filter {

/// When a pipeline counts as overloaded.
struct LoadLimits {
  double max_latency_ms = 66;   ///< camera to pose; two frames at 30 Hz
  double easy_latency_ms = 45;  ///< smoothed; below it there is room for more work
  int window = 10;              ///< frames that are judged together
  int max_burdened = 1;         ///< late or missing ones of them, more are too many
  double settle_s = 0.2;        ///< after a step was shed: frames on their way know nothing of it yet
  double calm_s = 3;            ///< without a missing frame and with an easy latency before a step is taken back
  double longest_calm_s = 60;   ///< a step that was taken back too early is tried again only after twice the time
};

/// Finds out from the poses that come back whether the pipeline keeps up, and how many steps of load it should shed:
/// one more after each window with too many late or missing frames, one less after a calm time. Knows no clock: times
/// are arguments. One thread.
class LoadWatch {
 public:
  /// `first`: the step to begin with, for a computer that is known to be slow.
  LoadWatch(const LoadLimits& limits, int steps, int first = 0) : limits_(limits), steps_(steps), step_(first) {}

  /// A pose has come back. Frames that are missing between two poses count as burdened; a gap that is longer than the
  /// window is a pause, not a burden. True when step() has changed.
  bool add(std::uint64_t seq, double latency_ms, std::int64_t now_ns);
  /// Nothing ran for a while until now: less work would not have helped, so what is late or missing because of it is no
  /// burden. Where that happens more than once a second, it is.
  void stood_still(std::int64_t now_ns);
  /// 0 = nothing is shed.
  int step() const { return step_; }
  /// Of the window that led to the last change.
  int burdened() const { return burdened_; }
  int window() const { return limits_.window; }

 private:
  bool shed(std::int64_t now_ns);
  bool take_back(std::int64_t now_ns);

  LoadLimits limits_;
  int steps_;
  int step_;
  int burdened_ = 0;
  std::optional<std::uint64_t> last_seq_;
  std::deque<bool> recent_;  ///< whether each of the last frames was burdened
  double smooth_latency_ms_ = 0;
  std::int64_t calm_since_ns_ = 0;
  std::int64_t settled_ns_ = 0;  ///< before it nothing more is shed
  std::int64_t stood_still_ns_ = 0;
  std::int64_t excused_ns_ = 0;  ///< frames that were published before it do not count
  std::int64_t taken_back_ns_ = 0;
  double calm_s_ = limits_.calm_s;  ///< how long it must be calm now
};

}  // namespace rtd::filter
