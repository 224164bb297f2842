// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/slam/core/map/trajectory.hpp"
#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// Frames that were tracked while surfaces were in question, and so without them. When it is known what rests, their
/// poses are found again with all of it. docs/theory/tracking.md, "Surfaces in question".
class UnsettledFrames {
 public:
  /// Takes in the next tracked frame. Once nothing has been in question for long enough that keyframes have seen it,
  /// those that wait are judged again in `map`. A frame keeps its pose in `frames` where its keyframe is not in the map
  /// or too few landmarks agree; one that is no longer recorded does not count.
  void add(const TrackedFrame& tracked, const LocalMap& map, const TrackingContext& context,
           std::vector<FrameRecord>& frames);

 private:
  std::vector<TrackedFrame> waiting_;
  std::int64_t in_question_ns_ = 0;  ///< stamp of the last frame that had something in question
};

}  // namespace rtd::slam
