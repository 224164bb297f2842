// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/settling.hpp"

#include <algorithm>
#include <utility>

#include "common/msg/stamps.hpp"

namespace rtd::slam {

std::vector<TrackedFrame> UnsettledFrames::add(const TrackedFrame& tracked) {
  constexpr std::int64_t kSettledNs = 300'000'000;
  constexpr std::size_t kMost = 60;  // frames are in question for half a second
  const std::vector<msg::Feature>& features = tracked.frame->features;
  const bool in_question = std::any_of(features.begin(), features.end(), [](const msg::Feature& feature) {
    return (feature.flags & msg::kFeatureInQuestion) != 0;
  });
  if (in_question) {
    in_question_ns_ = tracked.frame->stamp_ns;
    if (waiting_.size() < kMost) waiting_.push_back(tracked);
    return {};
  }
  if (msg::minus_ns(tracked.frame->stamp_ns, in_question_ns_) < kSettledNs) return {};
  return std::exchange(waiting_, {});
}

void judge_again(const TrackedFrame& tracked, const LocalMap& map, const TrackingContext& context,
                 std::vector<FrameRecord>& frames) {
  const auto record = std::find_if(frames.rbegin(), frames.rend(),
                                   [&](const FrameRecord& frame) { return frame.seq == tracked.frame->seq; });
  const LocalKeyframe* reference = record == frames.rend() ? nullptr : map.find_keyframe(record->reference);
  if (reference == nullptr) return;
  PoseGuess guess;
  guess.T_world_camera = reference->T_world_camera * record->T_reference_camera;
  guess.landmarks = tracked.landmarks;
  const PoseGuess again = track_local_map(*tracked.frame, map, guess, context).guess;
  if (!again.success || again.inliers < context.config.tracker.min_inliers) return;
  record->T_reference_camera = geometry::normalized(reference->T_world_camera.inverse() * again.T_world_camera);
}

}  // namespace rtd::slam
