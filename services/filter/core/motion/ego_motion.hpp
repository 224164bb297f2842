// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/motion/guided_matching.hpp"

namespace rtd::filter {

/// Input of the estimate of the camera's motion.
struct EgoMotionInput {
  SearchableFeatures current;
  const std::vector<char>& excluded;   ///< per feature, 1 = on something that may move: not used for the pose
  const std::vector<int>& cluster_of;  ///< per feature, depth cluster or -1
  const DepthClusters& clusters;
  const ViewStore& views;  ///< not empty
  std::int64_t stamp_ns;
  Eigen::Isometry3d T_world_camera_predicted;
  std::int64_t look_back_ns =
      0;  ///< also compare with a view this old, to find what moves too slowly for 0.1 s; 0 = not in this frame
};

/// The quick pose of the current frame and what it was found from.
struct EgoMotion {
  bool settled =
      false;  ///< found against a view at least 0.09 s old: movers could be distinguished from the camera's own motion
  bool reliable = false;  ///< otherwise the pose is only the prediction and geometry makes no statement
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int inliers = 0;
  FeatureVotes votes;       ///< of the features found again in the view 0.1 s ago, movers included
  FeatureVotes old_votes;   ///< and in the view 0.5 s ago, near their place
  FeatureVotes slow_votes;  ///< and in one of up to 1.5 s ago; none in most frames
};

/// Slow votes are counted only so often: what is slow can wait.
inline constexpr std::int64_t kLookBackEveryNs = 100'000'000;

/// A pose found over less time may have followed a mover.
inline constexpr std::int64_t kMinSettledAgeNs = 90'000'000;

/// Pose of the current frame from what stands still: features matched with the view 0.1 s ago (one frame is too short:
/// on distant walls a shift nearly looks like a rotation, and one motion explains walls and mover), the motion that
/// most of the image agrees with, without the clusters that move as a whole against it; then refined
/// (common/vision/pose_optimizer), against older views too, so that errors do not add up. docs/theory/dynamic_points.md
/// section 2.
EgoMotion estimate_ego_motion(const EgoMotionInput& input, const EgoMotionConfig& config,
                              const GeometryConfig& geometry);

}  // namespace rtd::filter
