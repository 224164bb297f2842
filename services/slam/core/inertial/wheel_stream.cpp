// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/inertial/wheel_stream.hpp"

#include <algorithm>
#include <cmath>

#include "common/inertial/preintegration.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kMaxWheelSamples = 4096;

/// The pose a share of the way from one to the other; beyond 1 the motion continues.
Eigen::Isometry3d between(const Eigen::Isometry3d& T_a, const Eigen::Isometry3d& T_b, double share) {
  return T_a * geometry::se3_exp(share * geometry::se3_log(T_a.inverse() * T_b));
}

/// A base that is put elsewhere, or odometry that began again.
bool is_jump(const WheelSample& before, const WheelSample& sample) {
  constexpr double kMost_m_s = 20, kMost_rad_s = 30, kAlways_m = 0.05;
  const double gap_s = inertial::seconds_between(before.stamp_ns, sample.stamp_ns);
  const Eigen::Isometry3d T = before.T_odom_base.inverse() * sample.T_odom_base;
  return T.translation().norm() > kMost_m_s * gap_s + kAlways_m ||
         geometry::rotation_angle_rad(T) > kMost_rad_s * gap_s + kAlways_m;
}

}  // namespace

void WheelStream::add(const WheelSample& sample) {
  constexpr int kStraysOfAJump = 20;
  const bool finite = sample.T_odom_base.matrix().allFinite() && std::isfinite(sample.speed_variance) &&
                      std::isfinite(sample.turning_variance);
  if (!finite || std::abs(sample.T_odom_base.linear().determinant() - 1) > 0.01) {
    ++counters_.invalid;
    return;
  }
  if (!samples_.empty() && sample.stamp_ns <= samples_.back().stamp_ns) {
    ++counters_.out_of_order;
    if (++strays_ < kStraysOfAJump) return;
    ++counters_.jumps;  // the clock was set back
    samples_.clear();
  }
  strays_ = 0;
  if (!samples_.empty()) {
    if (inertial::seconds_between(samples_.back().stamp_ns, sample.stamp_ns) > kMaxGap_s) ++counters_.gaps;
    if (is_jump(samples_.back(), sample)) {
      ++counters_.jumps;
      samples_.clear();
    }
  }
  if (samples_.size() >= kMaxWheelSamples) samples_.pop_front();
  ++counters_.taken;
  samples_.push_back(sample);
}

std::optional<Eigen::Isometry3d> WheelStream::pose_at(std::int64_t stamp_ns) const {
  const auto before = [](const WheelSample& sample, std::int64_t ns) { return sample.stamp_ns < ns; };
  auto next = std::lower_bound(samples_.begin(), samples_.end(), stamp_ns, before);
  if (next != samples_.end() && next->stamp_ns == stamp_ns) return next->T_odom_base;
  if (next == samples_.begin() || samples_.size() < 2) return std::nullopt;
  if (next == samples_.end()) {
    if (inertial::seconds_between(samples_.back().stamp_ns, stamp_ns) > kMaxGap_s) return std::nullopt;
    --next;
  }
  const WheelSample &a = *std::prev(next), &b = *next;
  if (inertial::seconds_between(a.stamp_ns, b.stamp_ns) > kMaxGap_s) return std::nullopt;
  return between(a.T_odom_base, b.T_odom_base,
                 inertial::seconds_between(a.stamp_ns, stamp_ns) / inertial::seconds_between(a.stamp_ns, b.stamp_ns));
}

std::optional<WheelMotion> WheelStream::motion(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto T_odom_first = pose_at(from_ns), T_odom_last = pose_at(to_ns);
  if (!T_odom_first || !T_odom_last || to_ns <= from_ns) return std::nullopt;
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    const bool inside = samples_[i].stamp_ns > from_ns && samples_[i - 1].stamp_ns < to_ns;
    if (inside && inertial::seconds_between(samples_[i - 1].stamp_ns, samples_[i].stamp_ns) > kMaxGap_s)
      return std::nullopt;
  }
  WheelMotion motion;
  motion.T_first_last = T_odom_first->inverse() * *T_odom_last;
  motion.covariance = covariance_of(motion.T_first_last, inertial::seconds_between(from_ns, to_ns));
  return motion;
}

/// Wheels slip with the way, or as the messages say if that is more.
geometry::Matrix6d WheelStream::covariance_of(const Eigen::Isometry3d& T_first_last, double duration_s) const {
  const double way_m = T_first_last.translation().norm(), turn_rad = geometry::rotation_angle_rad(T_first_last);
  const WheelSample& newest = samples_.back();
  const auto square = [](double x) { return x * x; };
  const double way = square(config_.distance_share * way_m) + square(config_.still_m);
  const double turn = square(config_.turn_share * turn_rad) + square(config_.turn_rad_m * way_m);
  const double off_plane = square(config_.off_plane_share * way_m);
  const double way_variance = std::max(way, newest.speed_variance * square(duration_s));
  const double turn_variance = std::max(turn, newest.turning_variance * square(duration_s));
  geometry::Vector6d variances;
  constexpr double kLeast_rad2 = 1e-8;
  variances << way_variance, way_variance, off_plane + square(config_.still_m), off_plane + kLeast_rad2,
      off_plane + kLeast_rad2, turn_variance + kLeast_rad2;
  return variances.asDiagonal();
}

void WheelStream::forget_before(std::int64_t stamp_ns) {
  while (samples_.size() > 2 && samples_[1].stamp_ns <= stamp_ns) samples_.pop_front();
}

}  // namespace rtd::slam
