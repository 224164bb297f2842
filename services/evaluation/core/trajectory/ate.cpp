// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/ate.hpp"

namespace rtd::eval {

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
