// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/evaluation/core/trajectory/statistics.hpp"
#include "services/evaluation/core/trajectory/trajectory.hpp"

namespace rtd::eval {

/// What the step between the two poses of a pair is measured in.
enum class RpeUnit { kSeconds, kFrames, kMetres };

struct RpeOptions {
  double delta = 1;  ///< step, in `unit`
  RpeUnit unit = RpeUnit::kSeconds;
  double offset_s = 0;  ///< added to the stamps of the estimate
  double scale = 1;     ///< applied to the estimate's translations (Sim(3) alignment)
};

/// Error of the estimated motion over one step.
struct RpeSample {
  std::int64_t stamp_ns = 0;  ///< of the estimate, at the start of the step
  double translation_m = 0;
  double rotation_rad = 0;
};

struct RpeResult {
  Statistics translation_m, rotation_rad;  ///< count 0: no step fits
  std::vector<RpeSample> samples;
};

/// Relative pose error as TUM's evaluate_rpe.py with --fixed_delta: from every estimated pose to the one nearest to
/// `delta` later (frames and metres count along the estimate), compared with the ground-truth poses nearest in time.
/// Steps that reach the last pose and steps without ground truth within twice its median interval are left out.
/// docs/evaluation.md Eq. (6)-(8).
RpeResult rpe(const Trajectory& estimate, const Trajectory& groundtruth, const RpeOptions& options = {});

}  // namespace rtd::eval
