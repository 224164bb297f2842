// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/evaluation/core/trajectory/alignment.hpp"
#include "services/evaluation/core/trajectory/association.hpp"
#include "services/evaluation/core/trajectory/statistics.hpp"
#include "services/evaluation/core/trajectory/trajectory.hpp"

namespace rtd::eval {

struct AteOptions {
  AssociationOptions association;
  AlignmentKind alignment = AlignmentKind::kRigid;
};

/// One associated moment after alignment.
struct AtePoint {
  std::int64_t stamp_ns = 0;  ///< of the estimate
  Eigen::Vector3d groundtruth_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_m = Eigen::Vector3d::Zero();  ///< in the ground truth's world
  double error_m = 0;                                    ///< distance of the two
};

struct AteResult {
  Statistics error_m;  ///< count 0: nothing associated
  Alignment alignment;
  std::vector<AtePoint> points;
};

/// Absolute trajectory error: associate, align, distances of positions. docs/evaluation.md Eq. (1)-(5).
AteResult ate(const Trajectory& estimate, const Trajectory& groundtruth, const AteOptions& options = {});

}  // namespace rtd::eval
