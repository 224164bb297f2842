// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// Accepts surfaces that have arrived and stopped: older views saw through their place, but those of the last 0.7 s saw
/// them there, and their features are where they were 0.1 s (`quick`) and 0.5 s (`old`) ago. The verdict of the older
/// views is withdrawn there (`violated` cleared, `lasting` set): it shows that something has arrived, not that it
/// moves. Without this, a person who stops in front of a wall would count as moving for ever.
/// docs/theory/dynamic_points.md section 4.
DepthEvidence accept_arrivals(DepthEvidence evidence, const DepthClusters& clusters, const FeatureVotes& quick,
                              const FeatureVotes& old, const GeometryConfig& config);

/// What moves in a frame, from geometry alone.
struct DynamicRegions {
  bool trusted = false;  ///< false: no statement (no pose, or an implausibly large part of the image moves)
  CellMask hold_cs;      ///< 0 = not dynamic, else for how many 1/100 s this holds without new evidence
  int clusters = 0;      ///< depth clusters that are dynamic as a whole
};

/// Displaced features, over 0.1 s and, in some frames, over a second or more.
struct MotionVotes {
  const FeatureVotes& quick;
  const FeatureVotes& slow;
};

/// As in DynamicRegions::hold_cs; at most 2.55 s.
std::uint8_t to_cs(double time_s);

/// DynamicRegions::hold_cs of the last frame, brought to this one, and the time since.
struct RememberedMotion {
  CellMask hold_cs;
  int elapsed_cs = 0;  ///< 1/100 s
};

/// Judges whole depth clusters (share of violated cells, votes of displaced features, or memory) and, inside clusters
/// that are not dynamic, compact groups of violated or remembered cells. Parts of a dynamic cluster that demonstrably
/// rest are left out. docs/theory/dynamic_points.md section 4.
DynamicRegions find_dynamic_regions(const DepthClusters& clusters, const DepthEvidence& evidence,
                                    const MotionVotes& votes, const RememberedMotion& remembered,
                                    const GeometryConfig& config);

/// Where things moved in the last frame, so that a mover that slows down or pauses does not count as static at once.
class DynamicMemory {
 public:
  /// `hold_cs` per cell of the frame just judged; its points are kept in the camera frame.
  void store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays, const std::vector<std::uint8_t>& hold_cs);
  /// The same, seen from the current frame: points follow the camera's motion and count where the depth is about their
  /// own, give or take what a mover covers in `elapsed_s`.
  std::vector<std::uint8_t> recall(const DepthGrid& grid, const geometry::CameraModel& camera,
                                   const Eigen::Isometry3d& T_current_last, double elapsed_s) const;
  void clear() { points_.clear(); }

 private:
  struct Point {
    Eigen::Vector3f p_camera;
    std::uint8_t hold_cs;
  };
  std::vector<Point> points_;
};

}  // namespace rtd::filter
