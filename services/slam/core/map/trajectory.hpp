// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/trajectory.hpp"
#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// A tracked frame relative to a keyframe, so that it follows when the map is corrected.
struct FrameRecord {
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  KeyframeId reference = kNoKeyframe;
  Eigen::Isometry3d T_reference_camera = Eigen::Isometry3d::Identity();
  bool doubtful = false;  ///< as published: mend_doubtful() finds such poses again
};

/// A long run keeps all frames of its last hours and ever fewer of the earlier ones: when there are `limit`, every
/// second one of the older half goes.
void thin_out(std::vector<FrameRecord>& frames, std::size_t limit);

/// Ties frames of keyframes that were removed to those that still exist.
void tie_to_living(std::vector<FrameRecord>& frames, const Map& map);

/// The record of a recent frame; null where there is none (any more).
FrameRecord* find_frame(std::vector<FrameRecord>& frames, std::uint64_t seq);

/// A pose that nothing was measured for.
struct PredictedPose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  ///< grows with time: (x y z rx ry rz), world frame
};

/// What later poses say of one that was predicted: it is T_world_camera * T_claimed_smoothed.
struct PoseCorrection {
  std::uint64_t seq = 0;
  Eigen::Isometry3d T_claimed_smoothed = Eigen::Isometry3d::Identity();
};

/// Corrects recent frames; those that are no longer there do not count.
void correct_frames(std::span<const PoseCorrection> corrections, std::vector<FrameRecord>& frames);

using geometry::StampedPose;

struct MapPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< p_world, m
  float static_probability = 1;
};

/// Finds the poses in doubt again that lie between poses that are not: those that need the least acceleration, and of
/// the doubtful ones what fits into that. Others stay. docs/theory/tracking.md, "Mended from both ends".
void mend_doubtful(std::vector<StampedPose>& poses, const std::vector<bool>& doubtful);

/// Final poses of the recorded frames: T_world_reference (as corrected by now) * T_reference_camera; those that were
/// in doubt are mended. Those of one map: each has its own world frame.
std::vector<StampedPose> compose_trajectory(const Map& map, const std::vector<FrameRecord>& frames, MapId id = 0);
/// Poses of the keyframes still in the map, oldest first.
std::vector<StampedPose> keyframe_trajectory(const Map& map, MapId id = 0);
/// All landmarks of one map whose place is known, by id: none that is at an assumed distance still.
std::vector<MapPoint> map_points(const Map& map, MapId id = 0);
/// Those of `landmarks` that are in this map, likewise.
void append_map_points(const Map& map, MapId id, std::span<const LandmarkId> landmarks, std::vector<MapPoint>& points);

/// ASCII PLY: x y z and static_probability per vertex.
void write_ply(std::ostream& out, const std::vector<MapPoint>& points);

}  // namespace rtd::slam
