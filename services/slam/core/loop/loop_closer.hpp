// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/slam/core/loop/essential_graph.hpp"
#include "services/slam/core/loop/loop_detector.hpp"

namespace rtd::slam {

/// What closing a loop changed.
struct LoopClosure {
  LoopEdge edge;
  std::int64_t older_ns = 0, newer_ns = 0;  ///< stamps of its keyframes
  MapId map = 0;                            ///< component that was corrected
  bool merged = false;                      ///< two maps became one
  double correction_m = 0;                  ///< how far the newest keyframe moved
  int joined = 0;                           ///< landmarks that became one, or gained an observation
};

/// Finds loops and puts the map right: pose graph, fusion, or the younger of two maps moved into the older one. Global
/// bundle adjustment is left to the caller. docs/theory/loop_closing.md. One thread, that of the mapper.
class LoopCloser {
 public:
  explicit LoopCloser(const SlamConfig& config) : config_(config), detector_(config) {}

  /// Looks for a loop at the newest keyframe, whose local mapping is done, and closes it.
  std::optional<LoopClosure> close(Map& map, const KeyframeDatabase& places, KeyframeId newest);
  const LoopCounters& counters() const { return detector_.counters(); }

 private:
  void straighten(Map& map, MapId component);
  MapId merge(Map& map, const Loop& loop);

  SlamConfig config_;
  LoopDetector detector_;
};

}  // namespace rtd::slam
