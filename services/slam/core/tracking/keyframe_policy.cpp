// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/keyframe_policy.hpp"

namespace rtd::slam {

KeyframeDecision decide_keyframe(const KeyframeSituation& s, const KeyframeConfig& config) {
  constexpr double kYoungMapRatio = 0.4;  // with one keyframe only, its landmarks are not yet confirmed
  const double ratio = s.map_keyframes < 2 ? kYoungMapRatio : config.reference_ratio;
  const bool starving_of_close =
      s.close_tracked < config.min_close_tracked && s.close_untracked > config.min_close_untracked;
  const bool overdue = s.frames_since_keyframe >= config.max_gap_frames;
  const bool convenient = s.frames_since_keyframe >= config.min_gap_frames && s.mapper_idle;
  const bool weak = s.inliers < config.weak_ratio * s.reference_landmarks || starving_of_close;
  const bool new_view = s.inliers < ratio * s.reference_landmarks || starving_of_close;
  const bool insert = (overdue || convenient || weak) && new_view && s.inliers > config.min_inliers;
  return insert ? KeyframeDecision::kOffer : KeyframeDecision::kNo;
}

}  // namespace rtd::slam
