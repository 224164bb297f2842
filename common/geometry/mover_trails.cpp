// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/mover_trails.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/msg/stamps.hpp"

namespace rtd::geometry {
namespace {

constexpr double kLong_s = 1.5, kShort_s = 0.75, kBetween_s = 0.04;

/// The measured velocity is within what its covariance makes likely for an object at rest.
bool may_be_noise(const msg::Mover& mover) {
  constexpr double kLikely = 11.34;  // 99 % of chi-square with 3 degrees of freedom
  const Eigen::Map<const Eigen::Vector3d> velocity_m_s(mover.velocity_mps.data());
  const Eigen::Map<const Eigen::Matrix<double, 6, 6>> covariance(mover.covariance.data());
  return !(velocity_m_s.dot(covariance.bottomRightCorner<3, 3>().ldlt().solve(velocity_m_s)) > kLikely);
}

/// How far both ends of an interval have gone, m; 0 where it has grown.
double way_of(double middle_then, double size_then, double middle, double size) {
  const double low = (middle - size / 2) - (middle_then - size_then / 2);
  const double high = (middle + size / 2) - (middle_then + size_then / 2);
  return low * high > 0 ? std::copysign(std::min(std::abs(low), std::abs(high)), low) : 0;
}

}  // namespace

std::vector<bool> MoverTrails::rest(const msg::Movers& frame) {
  const auto has_moved = [&frame](const Place& then, const msg::Mover& now) {
    constexpr double kLeastShare = 0.5;
    const double past_s = msg::minus_s(frame.stamp_ns, then.stamp_ns);
    if (past_s < kShort_s) return false;
    double along_m2_s = 0;
    for (std::size_t i = 0; i < 3; ++i)
      along_m2_s += now.velocity_mps[i] * way_of(then.center_m[i], then.size_m[i], now.center_m[i], now.size_m[i]);
    const double speed_m_s = Eigen::Map<const Eigen::Vector3d>(now.velocity_mps.data()).norm();
    return along_m2_s > kLeastShare * speed_m_s * speed_m_s * past_s;
  };
  const auto past = [&frame](const Place& place) {
    const double age_s = msg::minus_s(frame.stamp_ns, place.stamp_ns);
    return !(age_s > 0 && age_s <= kLong_s);
  };
  std::map<std::uint32_t, Trail> before = std::exchange(trails_, {});
  std::vector<bool> rest;
  for (const msg::Mover& mover : frame.movers) {
    Trail trail = std::move(before[mover.id]);
    std::erase_if(trail, past);
    rest.push_back(may_be_noise(mover) || trail.empty() || !has_moved(trail.front(), mover));
    if (trail.empty() || msg::minus_s(frame.stamp_ns, trail.back().stamp_ns) >= kBetween_s)
      trail.push_back({frame.stamp_ns, mover.center_m, mover.size_m});
    trails_[mover.id] = std::move(trail);
  }
  return rest;
}

}  // namespace rtd::geometry
