// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/evaluation/core/trajectory/statistics.hpp"
#include "services/evaluation/core/trajectory/trajectory.hpp"

namespace rtd::eval {

struct AssociationOptions {
  double max_difference_s = 0.02;  ///< pairs must be closer than this
  double offset_s = 0;             ///< added to the stamps of the estimate
};

/// Indices of two poses that belong to the same moment.
struct MatchedPair {
  std::size_t groundtruth = 0;
  std::size_t estimate = 0;
};

/// Pairs stamps as TUM's associate.py does: all candidates closer than max_difference_s, taken greedily by smallest
/// difference (ties: earlier ground truth, then earlier estimate), each stamp used once. Both inputs in increasing
/// order. The result is in order of the ground-truth stamps.
std::vector<MatchedPair> associate(const std::vector<std::int64_t>& groundtruth_ns,
                                   const std::vector<std::int64_t>& estimate_ns,
                                   const AssociationOptions& options = {});

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
