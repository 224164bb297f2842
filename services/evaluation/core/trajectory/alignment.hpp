// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace rtd::eval {

enum class AlignmentKind { kRigid, kSimilarity };  ///< SE(3) or Sim(3)

/// Maps points of the estimate's world into the ground truth's: p_gt = scale * R * p_est + t.
struct Alignment {
  double scale = 1;
  Eigen::Isometry3d T_groundtruth_estimate = Eigen::Isometry3d::Identity();
  bool unique = true;  ///< false: too few points or all on one line; the rotation is one of many equally good

  Eigen::Vector3d operator*(const Eigen::Vector3d& p_estimate) const {
    return scale * (T_groundtruth_estimate.linear() * p_estimate) + T_groundtruth_estimate.translation();
  }
};

/// Least-squares alignment of paired points in closed form (Horn 1987; Umeyama 1991 Eq. 40-42), docs/evaluation.md Eq.
/// (2)-(4). Column k of both matrices is one moment, metres. Any number of points works; none gives the identity.
Alignment align(const Eigen::Matrix3Xd& estimate_m, const Eigen::Matrix3Xd& groundtruth_m, AlignmentKind kind);

}  // namespace rtd::eval
