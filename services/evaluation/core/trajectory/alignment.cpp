// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/alignment.hpp"

#include <Eigen/SVD>

namespace rtd::eval {
namespace {

constexpr double kRankTolerance = 1e-9;  // relative to the largest singular value

/// +1, or -1 in the last place where the best orthogonal matrix would be a reflection.
Eigen::Vector3d reflection_guard(const Eigen::JacobiSVD<Eigen::Matrix3d>& svd) {
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1.0 : 1.0;
  return {1, 1, sign};
}

}  // namespace

Alignment align(const Eigen::Matrix3Xd& estimate_m, const Eigen::Matrix3Xd& groundtruth_m, AlignmentKind kind) {
  Alignment result;
  result.unique = false;
  if (estimate_m.cols() == 0) return result;
  const Eigen::Vector3d estimate_mean = estimate_m.rowwise().mean(), groundtruth_mean = groundtruth_m.rowwise().mean();
  const Eigen::Matrix3Xd estimate_centred = estimate_m.colwise() - estimate_mean;
  const Eigen::Matrix3Xd groundtruth_centred = groundtruth_m.colwise() - groundtruth_mean;

  const Eigen::Matrix3d cross_covariance = groundtruth_centred * estimate_centred.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross_covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d singular = svd.singularValues(), guard = reflection_guard(svd);
  const Eigen::Matrix3d R = svd.matrixU() * guard.asDiagonal() * svd.matrixV().transpose();

  const double variance = estimate_centred.squaredNorm();
  if (kind == AlignmentKind::kSimilarity && variance > 0 && singular[0] > 0)
    result.scale = singular.dot(guard) / variance;
  result.T_groundtruth_estimate.linear() = R;
  result.T_groundtruth_estimate.translation() = groundtruth_mean - result.scale * (R * estimate_mean);
  result.unique = singular[1] > kRankTolerance * singular[0];
  return result;
}

}  // namespace rtd::eval
