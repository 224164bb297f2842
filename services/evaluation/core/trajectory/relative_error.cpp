// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/relative_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {
namespace {

template <typename T>
std::size_t nearest(const std::vector<T>& ordered, T value) {
  const auto above = std::ranges::lower_bound(ordered, value);
  if (above == ordered.begin()) return 0;
  const auto index = static_cast<std::size_t>(above - ordered.begin());
  if (above == ordered.end()) return index - 1;
  return value - ordered[index - 1] <= ordered[index] - value ? index - 1 : index;
}

std::int64_t median_interval_ns(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<double> intervals_ns;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    intervals_ns.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  return intervals_ns.empty() ? 0 : std::llround(percentile(intervals_ns, 0.5));
}

Eigen::Isometry3d relative(const Eigen::Isometry3d& T_world_a, const Eigen::Isometry3d& T_world_b) {
  return T_world_a.inverse() * T_world_b;
}

/// Angle of a rotation in [0, pi], computed with atan2: near zero, an arc cosine of the trace turns rounding into 1e-8
/// rad.
double angle_rad(const Eigen::Matrix3d& R) {
  return Eigen::AngleAxisd(R).angle();
}

}  // namespace

std::size_t nearest_index(const std::vector<std::int64_t>& ordered, std::int64_t value) {
  return nearest(ordered, value);
}

std::size_t nearest_index(const std::vector<double>& ordered, double value) {
  return nearest(ordered, value);
}

StepError step_error(const Step& estimate, const Step& groundtruth, double scale) {
  // The step goes backwards, as in TUM's tool: forwards, the translation differs in the third digit.
  Eigen::Isometry3d T_to_from = relative(estimate.T_world_to, estimate.T_world_from);
  T_to_from.translation() *= scale;
  const Eigen::Isometry3d error = relative(T_to_from, relative(groundtruth.T_world_to, groundtruth.T_world_from));
  return {error.translation().norm(), angle_rad(error.linear())};
}

GroundtruthLookup::GroundtruthLookup(const geometry::Trajectory& groundtruth, double offset_s)
    : groundtruth_(groundtruth),
      stamps_ns_(geometry::stamps_of(groundtruth)),
      offset_ns_(std::llround(offset_s * 1e9)),
      max_difference_ns_(2 * median_interval_ns(stamps_ns_)) {}

const Eigen::Isometry3d* GroundtruthLookup::find(std::int64_t estimate_ns) const {
  const std::int64_t stamp_ns = estimate_ns + offset_ns_;
  const std::size_t index = nearest(stamps_ns_, stamp_ns);
  if (std::abs(stamps_ns_[index] - stamp_ns) > max_difference_ns_) return nullptr;
  return &groundtruth_[index].T_world_body;
}

}  // namespace rtd::eval
