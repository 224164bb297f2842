// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/motion/sightings.hpp"

namespace rtd::filter {

/// Slow votes are counted in every so many-th frame: what is slow can wait.
inline constexpr unsigned kFramesPerLookBack = 3;

/// Votes of the features found again in a view up to 1.5 s old: what moves at a few cm/s stays within the noise over
/// 0.1 s, but not over a second. The camera's motion since that view is found anew, by the agreement of the image, so
/// that neither drift of the quick pose nor a map that follows the mover is taken for motion of the rest.
/// Empty where no view is old enough (0.4 s) or the image does not agree. docs/theory/dynamic_points.md section 3.
FeatureVotes count_slow_votes(const EgoMotionInput& input, const Eigen::Isometry3d& T_world_camera,
                              const EgoMotionConfig& config, const GeometryConfig& geometry);

}  // namespace rtd::filter
