// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/geometry/trajectory.hpp"

namespace rtd::eval {

/// How far an estimated motion is from the true one.
struct StepError {
  double translation_m = 0, rotation_rad = 0;
};

/// A motion between two moments: the poses at both, in any world.
struct Step {
  const Eigen::Isometry3d &T_world_from, &T_world_to;
};

/// docs/evaluation.md Eq. (6)-(8). With `scale`, the translation of the estimate is multiplied by it first.
StepError step_error(const Step& estimate, const Step& groundtruth, double scale = 1);

/// Index of the entry nearest to `value` in an ordered, non-empty list; the earlier one when two are equally near.
std::size_t nearest_index(const std::vector<std::int64_t>& ordered, std::int64_t value);
std::size_t nearest_index(const std::vector<double>& ordered, double value);

/// Ground truth by time. The trajectory must outlive it and not be empty.
class GroundtruthLookup {
 public:
  /// `offset_s` is added to the stamps of the estimate.
  GroundtruthLookup(const geometry::Trajectory& groundtruth, double offset_s);

  /// Pose nearest to an estimate's stamp; null when ground truth has a gap there (twice its median interval).
  const Eigen::Isometry3d* find(std::int64_t estimate_ns) const;

 private:
  const geometry::Trajectory& groundtruth_;
  std::vector<std::int64_t> stamps_ns_;
  std::int64_t offset_ns_, max_difference_ns_;
};

}  // namespace rtd::eval
