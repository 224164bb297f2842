// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/rpe.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rtd::eval {
namespace {

/// Index of the entry nearest to `value` in an ordered, non-empty list; the earlier one when two are equally near.
template <typename T>
std::size_t nearest_index(const std::vector<T>& ordered, T value) {
  const auto above = std::lower_bound(ordered.begin(), ordered.end(), value);
  if (above == ordered.begin()) return 0;
  const auto index = static_cast<std::size_t>(above - ordered.begin());
  if (above == ordered.end()) return index - 1;
  return value - ordered[index - 1] <= ordered[index] - value ? index - 1 : index;
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

std::int64_t median_interval_ns(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<double> intervals_ns;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    intervals_ns.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  return intervals_ns.empty() ? 0 : std::llround(percentile(intervals_ns, 0.5));
}

/// Ground truth by time.
class GroundtruthLookup {
 public:
  GroundtruthLookup(const Trajectory& groundtruth, double offset_s)
      : groundtruth_(groundtruth),
        stamps_ns_(stamps_of(groundtruth)),
        offset_ns_(std::llround(offset_s * 1e9)),
        max_difference_ns_(2 * median_interval_ns(stamps_ns_)) {}

  /// Pose nearest to an estimate's stamp, null when ground truth has a gap there.
  const Eigen::Isometry3d* find(std::int64_t estimate_ns) const {
    const std::int64_t stamp_ns = estimate_ns + offset_ns_;
    const std::size_t index = nearest_index(stamps_ns_, stamp_ns);
    if (std::abs(stamps_ns_[index] - stamp_ns) > max_difference_ns_) return nullptr;
    return &groundtruth_[index].T_world_body;
  }

 private:
  const Trajectory& groundtruth_;
  std::vector<std::int64_t> stamps_ns_;
  std::int64_t offset_ns_, max_difference_ns_;
};

Eigen::Isometry3d relative(const Eigen::Isometry3d& T_world_a, const Eigen::Isometry3d& T_world_b) {
  return T_world_a.inverse() * T_world_b;
}

/// Angle of a rotation in [0, pi], computed with atan2: near zero, an arc cosine of the trace turns rounding into 1e-8
/// rad.
double angle_rad(const Eigen::Matrix3d& R) {
  return Eigen::AngleAxisd(R).angle();
}

}  // namespace

RpeResult rpe(const Trajectory& estimate, const Trajectory& groundtruth, const RpeOptions& options) {
  RpeResult result;
  if (estimate.size() < 2 || groundtruth.empty()) return result;
  const std::vector<double> axis = step_axis(estimate, options.unit);
  const GroundtruthLookup lookup(groundtruth, options.offset_s);
  std::vector<double> translations_m, rotations_rad;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::size_t j = nearest_index(axis, axis[i] + options.delta);
    if (j + 1 == estimate.size()) continue;  // the nearest pose may be far short of the full step there
    const Eigen::Isometry3d* T_gt_i = lookup.find(estimate[i].stamp_ns);
    const Eigen::Isometry3d* T_gt_j = lookup.find(estimate[j].stamp_ns);
    if (T_gt_i == nullptr || T_gt_j == nullptr) continue;

    // The step goes backwards, from j to i, as in TUM's tool: forwards, the translation differs in the third digit.
    Eigen::Isometry3d T_j_i = relative(estimate[j].T_world_body, estimate[i].T_world_body);
    T_j_i.translation() *= options.scale;
    const Eigen::Isometry3d error = relative(T_j_i, relative(*T_gt_j, *T_gt_i));
    result.samples.push_back({estimate[i].stamp_ns, error.translation().norm(), angle_rad(error.linear())});
    translations_m.push_back(result.samples.back().translation_m);
    rotations_rad.push_back(result.samples.back().rotation_rad);
  }
  result.translation_m = summarize(translations_m);
  result.rotation_rad = summarize(rotations_rad);
  return result;
}

}  // namespace rtd::eval
