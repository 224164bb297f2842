// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/evaluation/core/trajectory/ate.hpp"
#include "services/evaluation/core/trajectory/coverage.hpp"
#include "services/evaluation/core/trajectory/rpe.hpp"

namespace rtd::eval {

struct EvaluationOptions {
  AssociationOptions association;
  AlignmentKind alignment = AlignmentKind::kRigid;
  double max_gap_s = 0.5;  ///< longer gaps between poses count as lost when there is no frame list
};

/// Everything that is known of an estimate once its ground truth is.
struct Evaluation {
  std::size_t estimate_poses = 0, groundtruth_poses = 0;
  AteResult ate;
  RpeResult rpe_per_second, rpe_per_frame, rpe_per_metre;
  Coverage coverage;
};

/// ATE, RPE in the three units and coverage. With a similarity alignment its scale also applies to the RPE.
/// `frames_ns`: stamps of all frames of the run, in order; without them coverage refers to the ground truth's span.
Evaluation evaluate(const Trajectory& estimate, const Trajectory& groundtruth, const EvaluationOptions& options = {},
                    const std::optional<std::vector<std::int64_t>>& frames_ns = std::nullopt);

}  // namespace rtd::eval
