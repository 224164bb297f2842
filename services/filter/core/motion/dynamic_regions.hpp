// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_clusters.hpp"

namespace rtd::filter {

/// What has come and stopped: older views saw through its place, but those of the last 0.7 s saw it there, and its
/// features are where they were 0.1 s (`quick`) and 0.5 s (`old`) ago. Of such surfaces the verdict of the older views
/// is taken back (`violated` cleared, `lasting` set): they say what has come, not what moves. Without this a person who
/// stops before a wall would move for ever. docs/theory/dynamic_points.md section 4.
DepthEvidence accept_arrivals(DepthEvidence evidence, const DepthClusters& clusters, const FeatureVotes& quick,
                              const FeatureVotes& old, const GeometryConfig& config);

/// Where the frame moves, by geometry alone.
struct DynamicRegions {
  bool trusted = false;  ///< false: no statement (no pose, or more of the image moves than can be)
  CellMask frames_left;  ///< 0 = not dynamic, else how many frames this is believed without new evidence
  int clusters = 0;      ///< depth clusters that are dynamic as a whole
};

/// Displaced features, over 0.1 s and, in some frames, over a second or more.
struct MotionVotes {
  const FeatureVotes& quick;
  const FeatureVotes& slow;
};

/// Judges whole depth clusters (share of violating cells, votes of displaced features, or what was remembered of them)
/// and, inside clusters that are not dynamic, compact groups of violating or remembered cells. Parts of a dynamic
/// cluster that demonstrably rest are left out. docs/theory/dynamic_points.md section 4.
/// `remembered`: frames_left of the last frame, brought to this one.
DynamicRegions find_dynamic_regions(const DepthClusters& clusters, const DepthEvidence& evidence,
                                    const MotionVotes& votes, const CellMask& remembered, const GeometryConfig& config);

}  // namespace rtd::filter
