// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/slam/core/slam_config.hpp"

namespace rtd::slam {

/// What the decision looks at.
struct KeyframeSituation {
  int frames_since_keyframe = 0;
  int map_keyframes = 0;
  int inliers = 0;              ///< landmarks tracked in this frame
  int reference_landmarks = 0;  ///< confirmed landmarks of the reference keyframe
  int close_tracked = 0;        ///< close features that are landmarks
  int close_untracked = 0;      ///< close features that could become some
  bool mapper_idle = true;
};

enum class KeyframeDecision : std::uint8_t {
  kNo,
  kOffer,  ///< insert if the mapper has room
};

/// ORB-SLAM2's rule for RGB-D, docs/theory/tracking.md Eq. (6).
KeyframeDecision decide_keyframe(const KeyframeSituation& situation, const KeyframeConfig& config);

}  // namespace rtd::slam
