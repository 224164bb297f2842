// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// Two keyframes that were found to show the same place.
struct LoopEdge {
  KeyframeId older = kNoKeyframe, newer = kNoKeyframe;
  Eigen::Isometry3d T_older_newer = Eigen::Isometry3d::Identity();  ///< between their cameras, as measured
  int inliers = 0;  ///< landmarks of the old place that the newer keyframe was found to see
};

}  // namespace rtd::slam
