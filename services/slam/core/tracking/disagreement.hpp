// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// What a measured pose rests on, and what contradicts it.
struct PoseEvidence {
  FramePtr frame;  ///< null: nothing was measured
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int agreeing = 0;                   ///< landmarks
  std::vector<Association> rejected;  ///< recognised landmarks that contradict the pose
  int raster_scale = 1;               ///< FrameRaster::scale of the frame
};

/// A recognised landmark that is not where the pose shows it. Pixels of the camera's own image.
struct Disagreeing {
  Eigen::Vector2d seen_px, expected_px;
  int motion = -1;  ///< index of the motion that it follows; -1: none that it has in common with others
};

/// What several of them have done since they were mapped. World frame, m.
struct CommonMotion {
  int landmarks = 0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();  ///< of them, where the map has them
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();   ///< of that centre
};

struct Disagreement {
  std::vector<Disagreeing> landmarks;
  std::vector<CommonMotion> motions;  ///< the one that most follow first
};

/// Which landmarks contradict a pose, and which rigid motions they follow: up to three, each of at least eight
/// landmarks by more than a centimetre. Deterministic; a few milliseconds.
Disagreement explain(const PoseEvidence& evidence);

}  // namespace rtd::slam
