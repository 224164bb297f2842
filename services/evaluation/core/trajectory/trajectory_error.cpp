// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/trajectory_error.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace rtd::eval {

Statistics summarize(const std::vector<double>& values) {
  Statistics s;
  s.count = values.size();
  if (values.empty()) return s;
  const auto n = static_cast<double>(values.size());
  s.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum_squares = 0, sum_deviations = 0;
  for (const double v : values) {
    sum_squares += v * v;
    sum_deviations += (v - s.mean) * (v - s.mean);
  }
  s.rmse = std::sqrt(sum_squares / n);
  s.std_dev = std::sqrt(sum_deviations / n);
  s.median = percentile(values, 0.5);
  const auto [lowest, highest] = std::ranges::minmax_element(values);
  s.min = *lowest;
  s.max = *highest;
  return s;
}

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  const double position = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], position - static_cast<double>(below));
}

namespace {

constexpr double kRankTolerance = 1e-9;  // relative to the largest singular value

/// +1, or -1 in the last place where the best orthogonal matrix would be a reflection.
Eigen::Vector3d reflection_guard(const Eigen::JacobiSVD<Eigen::Matrix3d>& svd) {
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1.0 : 1.0;
  return {1, 1, sign};
}

/// Position of every pose on the axis along which steps are counted.
std::vector<double> step_axis(const Trajectory& estimate, RpeUnit unit) {
  std::vector<double> axis(estimate.size(), 0.0);
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    const StampedPose &before = estimate[i - 1], &now = estimate[i];
    switch (unit) {
      case RpeUnit::kSeconds:
        axis[i] = static_cast<double>(now.stamp_ns - estimate.front().stamp_ns) * 1e-9;
        break;
      case RpeUnit::kFrames:
        axis[i] = static_cast<double>(i);
        break;
      case RpeUnit::kMetres:
        axis[i] = axis[i - 1] + (now.T_world_body.translation() - before.T_world_body.translation()).norm();
        break;
    }
  }
  return axis;
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

std::vector<std::int64_t> shifted_stamps(const Trajectory& estimate, double offset_s) {
  std::vector<std::int64_t> stamps_ns = stamps_of(estimate);
  for (std::int64_t& stamp_ns : stamps_ns) stamp_ns += std::llround(offset_s * 1e9);
  return stamps_ns;
}

AteResult ate(const Trajectory& estimate, const Trajectory& groundtruth, const AteOptions& options) {
  const std::vector<geometry::StampPair> pairs =
      geometry::associate(stamps_of(groundtruth), shifted_stamps(estimate, options.association.offset_s),
                          std::llround(options.association.max_difference_s * 1e9));
  Eigen::Matrix3Xd estimate_m(3, pairs.size()), groundtruth_m(3, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    estimate_m.col(column) = estimate[pairs[i].second].T_world_body.translation();
    groundtruth_m.col(column) = groundtruth[pairs[i].first].T_world_body.translation();
  }

  AteResult result;
  result.alignment = align(estimate_m, groundtruth_m, options.alignment);
  std::vector<double> errors_m;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d aligned_m = result.alignment * estimate_m.col(column);
    errors_m.push_back((aligned_m - groundtruth_m.col(column)).norm());
    result.points.push_back(
        {estimate[pairs[i].second].stamp_ns, groundtruth_m.col(column), aligned_m, errors_m.back()});
  }
  result.error_m = summarize(errors_m);
  return result;
}

std::vector<StepError> relative_errors(const Trajectory& estimate, const Trajectory& groundtruth,
                                       const RpeOptions& options) {
  std::vector<StepError> errors;
  if (estimate.size() < 2 || groundtruth.empty()) return errors;
  const std::vector<double> axis = step_axis(estimate, options.unit);
  const GroundtruthLookup lookup(groundtruth, options.offset_s);
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::size_t j = nearest_index(axis, axis[i] + options.delta);
    if (j + 1 == estimate.size()) continue;  // the nearest pose may be far short of the full step there
    const Eigen::Isometry3d* T_gt_i = lookup.find(estimate[i].stamp_ns);
    const Eigen::Isometry3d* T_gt_j = lookup.find(estimate[j].stamp_ns);
    if (T_gt_i == nullptr || T_gt_j == nullptr) continue;
    errors.push_back(
        step_error({estimate[i].T_world_body, estimate[j].T_world_body}, {*T_gt_i, *T_gt_j}, options.scale));
  }
  return errors;
}

RpeResult rpe(const Trajectory& estimate, const Trajectory& groundtruth, const RpeOptions& options) {
  std::vector<double> translations_m, rotations_rad;
  for (const auto& [translation_m, rotation_rad] : relative_errors(estimate, groundtruth, options)) {
    translations_m.push_back(translation_m);
    rotations_rad.push_back(rotation_rad);
  }
  return {summarize(translations_m), summarize(rotations_rad)};
}

namespace {

std::int64_t median_interval_ns(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<double> intervals_ns;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    intervals_ns.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  return intervals_ns.empty() ? 0 : std::llround(percentile(intervals_ns, 0.5));
}

}  // namespace

StepError step_error(const Step& estimate, const Step& groundtruth, double scale) {
  // The step goes backwards, as in TUM's tool: forwards, the translation differs in the third digit.
  Eigen::Isometry3d T_to_from = estimate.T_world_to.inverse() * estimate.T_world_from;
  T_to_from.translation() *= scale;
  const Eigen::Isometry3d T_true = groundtruth.T_world_to.inverse() * groundtruth.T_world_from;
  const Eigen::Isometry3d error = T_to_from.inverse() * T_true;
  return {error.translation().norm(), Eigen::AngleAxisd(error.linear()).angle()};
}

GroundtruthLookup::GroundtruthLookup(const geometry::Trajectory& groundtruth, double offset_s)
    : groundtruth_(groundtruth),
      stamps_ns_(geometry::stamps_of(groundtruth)),
      offset_ns_(std::llround(offset_s * 1e9)),
      max_difference_ns_(2 * median_interval_ns(stamps_ns_)) {}

const Eigen::Isometry3d* GroundtruthLookup::find(std::int64_t estimate_ns) const {
  const std::int64_t stamp_ns = estimate_ns + offset_ns_;
  const std::size_t index = nearest_index(stamps_ns_, stamp_ns);
  if (std::abs(stamps_ns_[index] - stamp_ns) > max_difference_ns_) return nullptr;
  return &groundtruth_[index].T_world_body;
}

}  // namespace rtd::eval
