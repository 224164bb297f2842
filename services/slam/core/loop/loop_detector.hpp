// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/slam/core/loop/place_meeting.hpp"
#include "services/slam/core/place/keyframe_database.hpp"

namespace rtd::slam {

/// Two parts of the map that are the same place, as the newest keyframe saw it.
struct Loop {
  KeyframeId keyframe = kNoKeyframe;
  PlaceMeeting meeting;
};

/// What became of the candidates so far; for diagnostics and tests.
struct LoopCounters {
  std::size_t candidates = 0;     ///< compared
  std::size_t met = 0;            ///< found by geometry
  std::size_t implausible = 0;    ///< of those, too far off for the way walked
  std::size_t contradictory = 0;  ///< of those, asking for another correction than the keyframe before
};

/// Finds out whether the newest keyframe is at a known place: candidates by words outside its covisible neighbourhood,
/// geometry, plausibility against the way walked, and agreement over several keyframes. docs/theory/loop_closing.md,
/// "Detection". Reads the map only; one thread.
class LoopDetector {
 public:
  explicit LoopDetector(const SlamConfig& config) : config_(config) {}

  /// The loop that the newest keyframe confirms, once enough keyframes agree.
  std::optional<Loop> detect(const Map& map, const KeyframeDatabase& places, KeyframeId newest);
  /// The map has been corrected: what was seen before is no hypothesis any more.
  void forget() { hypothesis_.reset(); }
  const LoopCounters& counters() const { return counters_; }

 private:
  /// A correction that the last keyframes agree on.
  struct Hypothesis {
    KeyframeId keyframe = kNoKeyframe, place = kNoKeyframe;  ///< the last that did
    Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();
    int confirmations = 0, misses = 0;
  };

  std::optional<PlaceMeeting> meet(const Map& map, const KeyframeDatabase& places, KeyframeId newest);
  bool plausible(const Map& map, KeyframeId newest, const PlaceMeeting& meeting) const;
  bool agrees(const Map& map, KeyframeId newest, const PlaceMeeting& meeting) const;

  SlamConfig config_;
  std::optional<Hypothesis> hypothesis_;
  LoopCounters counters_;
};

}  // namespace rtd::slam
