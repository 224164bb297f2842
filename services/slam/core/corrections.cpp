// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/corrections.hpp"

#include <algorithm>
#include <iterator>

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

std::vector<PoseCorrection> OdometryStretch::spread(const Eigen::Isometry3d& T_world_expected,
                                                    const Eigen::Isometry3d& T_world_found) const {
  const Eigen::Vector3d error_m = T_world_found.translation() - T_world_expected.translation();
  const Eigen::AngleAxisd turn(T_world_found.linear() * T_world_expected.linear().transpose());
  std::vector<PoseCorrection> corrections;
  corrections.reserve(frames_.size());
  for (const auto& [seq, T_world_camera] : frames_) {
    const double share = static_cast<double>(corrections.size() + 1) / static_cast<double>(frames_.size() + 1);
    Eigen::Isometry3d T_world_smoothed = T_world_camera;
    T_world_smoothed.translation() += share * error_m;
    T_world_smoothed.linear() = Eigen::AngleAxisd(share * turn.angle(), turn.axis()) * T_world_camera.linear();
    corrections.push_back({seq, T_world_camera.inverse() * T_world_smoothed});
  }
  return corrections;
}

void KeyframeChangeQueue::add(const std::vector<KeyframeChange>& changes) {
  for (const KeyframeChange& change : changes) {
    if (change.kind == KeyframeChange::Kind::kCorrected) {
      corrected_[change.id] = change;
    } else {
      corrected_.erase(change.id);
      in_order_.push_back(change);
    }
  }
}

std::vector<KeyframeChange> KeyframeChangeQueue::take(std::size_t count) {
  std::vector<KeyframeChange> changes;
  while (changes.size() < count && !in_order_.empty()) {
    changes.push_back(in_order_.front());
    in_order_.pop_front();
  }
  while (changes.size() < count && !corrected_.empty()) {
    const auto newest = std::prev(corrected_.end());
    changes.push_back(newest->second);
    corrected_.erase(newest);
  }
  return changes;
}

void DeferredFrames::add(const TrackedFrame& tracked, const LocalMap& map, const TrackingContext& context,
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
