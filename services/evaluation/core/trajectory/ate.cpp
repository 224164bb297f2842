// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/ate.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

namespace rtd::eval {
namespace {

struct Candidate {
  std::int64_t difference_ns = 0;
  MatchedPair pair;
};

std::vector<Candidate> close_pairs(const std::vector<std::int64_t>& groundtruth_ns,
                                   const std::vector<std::int64_t>& estimate_ns, const AssociationOptions& options) {
  const std::int64_t max_difference_ns = std::llround(options.max_difference_s * 1e9);
  const std::int64_t offset_ns = std::llround(options.offset_s * 1e9);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < estimate_ns.size(); ++i) {
    const std::int64_t stamp_ns = estimate_ns[i] + offset_ns;
    auto it = std::upper_bound(groundtruth_ns.begin(), groundtruth_ns.end(), stamp_ns - max_difference_ns);
    for (; it != groundtruth_ns.end() && *it < stamp_ns + max_difference_ns; ++it) {
      candidates.push_back({std::abs(*it - stamp_ns), {static_cast<std::size_t>(it - groundtruth_ns.begin()), i}});
    }
  }
  return candidates;
}

constexpr double kRankTolerance = 1e-9;  // relative to the largest singular value

/// +1, or -1 in the last place where the best orthogonal matrix would be a reflection.
Eigen::Vector3d reflection_guard(const Eigen::JacobiSVD<Eigen::Matrix3d>& svd) {
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1.0 : 1.0;
  return {1, 1, sign};
}

}  // namespace

std::vector<MatchedPair> associate(const std::vector<std::int64_t>& groundtruth_ns,
                                   const std::vector<std::int64_t>& estimate_ns, const AssociationOptions& options) {
  std::vector<Candidate> candidates = close_pairs(groundtruth_ns, estimate_ns, options);
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.difference_ns, a.pair.groundtruth, a.pair.estimate) <
           std::tie(b.difference_ns, b.pair.groundtruth, b.pair.estimate);
  });
  std::vector<bool> groundtruth_used(groundtruth_ns.size()), estimate_used(estimate_ns.size());
  std::vector<MatchedPair> matches;
  for (const auto& [difference_ns, pair] : candidates) {
    if (groundtruth_used[pair.groundtruth] || estimate_used[pair.estimate]) continue;
    groundtruth_used[pair.groundtruth] = estimate_used[pair.estimate] = true;
    matches.push_back(pair);
  }
  std::sort(matches.begin(), matches.end(),
            [](const MatchedPair& a, const MatchedPair& b) { return a.groundtruth < b.groundtruth; });
  return matches;
}

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

AteResult ate(const Trajectory& estimate, const Trajectory& groundtruth, const AteOptions& options) {
  const std::vector<MatchedPair> pairs = associate(stamps_of(groundtruth), stamps_of(estimate), options.association);
  Eigen::Matrix3Xd estimate_m(3, pairs.size()), groundtruth_m(3, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    estimate_m.col(column) = estimate[pairs[i].estimate].T_world_body.translation();
    groundtruth_m.col(column) = groundtruth[pairs[i].groundtruth].T_world_body.translation();
  }

  AteResult result;
  result.alignment = align(estimate_m, groundtruth_m, options.alignment);
  std::vector<double> errors_m;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d aligned_m = result.alignment * estimate_m.col(column);
    errors_m.push_back((aligned_m - groundtruth_m.col(column)).norm());
    result.points.push_back(
        {estimate[pairs[i].estimate].stamp_ns, groundtruth_m.col(column), aligned_m, errors_m.back()});
  }
  result.error_m = summarize(errors_m);
  return result;
}

}  // namespace rtd::eval
