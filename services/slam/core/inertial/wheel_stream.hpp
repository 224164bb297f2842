// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "common/geometry/se3.hpp"
#include "services/slam/core/slam_config.hpp"

namespace rtd::slam {

/// Where the wheels say that the base is.
struct WheelSample {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_odom_base = Eigen::Isometry3d::Identity();
  /// Variances of the forward and of the turning speed, (m/s)^2 and (rad/s)^2; 0: the message has none.
  double speed_variance = 0, turning_variance = 0;
};

/// A motion of the base between two moments.
struct WheelMotion {
  Eigen::Isometry3d T_first_last = Eigen::Isometry3d::Identity();
  /// Of (x y z rx ry rz), as poses have it, in the axes of the first moment.
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
};

struct WheelCounters {
  std::uint64_t taken = 0, invalid = 0, out_of_order = 0, gaps = 0, jumps = 0;
  std::uint64_t dropped() const { return invalid + out_of_order; }
};

/// The newest messages of a wheel odometry, in the order of their stamps. Not thread-safe.
class WheelStream {
 public:
  static constexpr double kMaxGap_s = 0.25;  ///< nothing is known of the motion in a longer pause

  explicit WheelStream(const WheelConfig& config) : config_(config) {}
  void add(const WheelSample& sample);
  bool empty() const { return samples_.empty(); }
  std::int64_t newest_ns() const { return samples_.empty() ? 0 : samples_.back().stamp_ns; }
  const WheelCounters& counters() const { return counters_; }

  /// Empty when the messages do not cover the span, but for kMaxGap_s at its end, over which the last motion continues.
  /// docs/theory/inertial.md Eq. (10).
  std::optional<WheelMotion> motion(std::int64_t from_ns, std::int64_t to_ns) const;
  void forget_before(std::int64_t stamp_ns);

 private:
  std::optional<Eigen::Isometry3d> pose_at(std::int64_t stamp_ns) const;
  geometry::Matrix6d covariance_of(const Eigen::Isometry3d& T_first_last, double duration_s) const;

  WheelConfig config_;
  std::deque<WheelSample> samples_;
  int strays_ = 0;
  WheelCounters counters_;
};

}  // namespace rtd::slam
