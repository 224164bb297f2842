// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/slam/core/map/trajectory.hpp"
#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// Frames that were tracked while surfaces were in question, and so without them. When it is known what rests, their
/// poses can be found again with all of it. docs/theory/tracking.md, "Surfaces in question".
class UnsettledFrames {
 public:
  /// Takes in the next tracked frame. Returns the frames that are to be judged again: all that wait, once nothing has
  /// been in question for long enough that keyframes have seen it; else none.
  std::vector<TrackedFrame> add(const TrackedFrame& tracked);

 private:
  std::vector<TrackedFrame> waiting_;
  std::int64_t in_question_ns_ = 0;  ///< stamp of the last frame that had something in question
};

/// Finds the pose of a recorded frame again in the map as it is now. It keeps the old one where its keyframe is not in
/// `map` or too few landmarks agree; frames that are no longer recorded do not count.
void judge_again(const TrackedFrame& tracked, const LocalMap& map, const TrackingContext& context,
                 std::vector<FrameRecord>& frames);

}  // namespace rtd::slam
