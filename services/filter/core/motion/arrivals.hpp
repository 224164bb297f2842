// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/filter/core/motion/depth_check.hpp"
#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/surfaces/depth_clusters.hpp"

namespace rtd::filter {

/// What has come and stopped: older views saw through its place, but those of the last 0.7 s saw it there, and its
/// features are where they were 0.1 s (`quick`) and 0.5 s (`old`) ago. Of such surfaces the verdict of the older views
/// is taken back (`violated` cleared, `lasting` set): they say what has come, not what moves. Without this a person who
/// stops before a wall would move for ever. docs/theory/dynamic_points.md section 4.
DepthEvidence accept_arrivals(DepthEvidence evidence, const DepthClusters& clusters, const FeatureVotes& quick,
                              const FeatureVotes& old, const GeometryConfig& config);

}  // namespace rtd::filter
