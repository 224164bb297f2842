// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/settling.hpp"

#include <algorithm>

#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

bool has_questions(const Frame& frame) {
  return std::any_of(frame.features.begin(), frame.features.end(),
                     [](const msg::Feature& feature) { return (feature.flags & msg::kFeatureInQuestion) != 0; });
}

void judge_again(const TrackedFrame& tracked, const LocalMap& map, const TrackingContext& context,
                 FrameRecord& record) {
  const LocalKeyframe* reference = map.find_keyframe(record.reference);
  if (reference == nullptr) return;
  PoseGuess guess;
  guess.T_world_camera = reference->T_world_camera * record.T_reference_camera;
  guess.landmarks = tracked.landmarks;
  const PoseGuess again = track_local_map(*tracked.frame, map, guess, context).guess;
  if (!again.success || again.inliers < context.config.tracker.min_inliers) return;
  record.T_reference_camera = geometry::normalized(reference->T_world_camera.inverse() * again.T_world_camera);
}

}  // namespace

void UnsettledFrames::add(const TrackedFrame& tracked, const LocalMap& map, const TrackingContext& context,
                          std::vector<FrameRecord>& frames) {
  constexpr std::int64_t kSettledNs = 300'000'000;
  constexpr std::size_t kMost = 60;  // frames are in question for half a second
  if (has_questions(*tracked.frame)) {
    in_question_ns_ = tracked.frame->stamp_ns;
    if (waiting_.size() < kMost) waiting_.push_back(tracked);
    return;
  }
  if (msg::minus_ns(tracked.frame->stamp_ns, in_question_ns_) < kSettledNs) return;
  for (const TrackedFrame& waited : waiting_) {
    if (FrameRecord* record = find_frame(frames, waited.frame->seq)) judge_again(waited, map, context, *record);
  }
  waiting_.clear();
}

}  // namespace rtd::slam
