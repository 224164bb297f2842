// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "common/geometry/se3.hpp"
#include "common/inertial/preintegration.hpp"
#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/inertial/inertial_filter.hpp"

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

/// Where the camera is by IMU and wheels, from the poses that slam measured before: docs/theory/inertial.md. Tracking
/// searches there, and while it measures nothing this is the pose. Deterministic. Not thread-safe.
class MotionPrior {
 public:
  explicit MotionPrior(const SlamConfig& config);

  void add(inertial::ImuSample sample);
  void add(const WheelSample& sample) { wheels_.add(sample); }
  /// Whether everything up to this stamp has come.
  bool reaches(std::int64_t stamp_ns) const;

  /// The frame in work. Its expected pose, once IMU or wheels can say one; the covariance is relative to the map.
  std::optional<PredictedPose> advance(std::int64_t stamp_ns);
  /// How the camera has turned from then to the frame in work, by the gyroscope; empty without one.
  std::optional<inertial::CameraTurn> turn_since(std::int64_t from_ns) const;
  /// Its pose by the map, covariance relative to the map. The expected pose with it.
  std::optional<PredictedPose> correct(const PredictedPose& measured);
  /// Its expected pose if what was learnt before the last update() may be wrong: that doubt grows with the time since.
  /// Only an IMU learns.
  std::optional<PredictedPose> doubted() const;
  /// A pose that is believed contradicts the expected one: what was learnt was wrong.
  void doubt();
  /// As correct(), by a pose that needs no support by the prior.
  void update(const PredictedPose& measured);
  /// The camera was found elsewhere than it was expected.
  void relocate(const PredictedPose& measured);
  /// The pose of the frame in work is claimed as expected; what an IMU says about it later is a correction.
  void remember(std::uint64_t seq);
  std::vector<PoseCorrection> take_corrections();
  /// The map was corrected under the camera.
  void move(const Eigen::Isometry3d& T_new_old);
  /// The next pose is in another world.
  void forget_world() { elsewhere_ = true; }
  /// Stamps begin again.
  void restart();

  /// The up direction in the camera's axes, of length 1: the mean of an accelerometer that rests just now, or what the
  /// filter has learned; empty before either. Eq. (13).
  std::optional<Eigen::Vector3d> up_in_camera() const;
  const std::optional<InertialFilter>& filter() const { return filter_; }
  const inertial::ImuCounters& imu_counters() const { return imu_.counters(); }
  const WheelCounters& wheel_counters() const { return wheels_.counters(); }

 private:
  void advance_filter(std::int64_t stamp_ns);
  void use_wheels(const inertial::Preintegration& motion, const Eigen::Isometry3d& T_world_imu_before,
                  std::int64_t from_ns);
  std::optional<PredictedPose> by_wheels() const;
  std::optional<PredictedPose> expected() const;
  void begin_filter(const PredictedPose& measured);

  SlamConfig config_;
  Eigen::Isometry3d T_imu_camera_, T_imu_base_;
  inertial::ImuStream imu_;
  WheelStream wheels_;
  std::optional<InertialFilter> filter_;
  std::optional<PredictedPose> last_;  ///< measured, at last_ns_: where the wheels continue from
  std::int64_t last_ns_ = 0;
  std::int64_t now_ns_ = 0;     ///< the frame in work
  std::int64_t before_ns_ = 0;  ///< the frame before
  bool elsewhere_ = false;
};

}  // namespace rtd::slam
