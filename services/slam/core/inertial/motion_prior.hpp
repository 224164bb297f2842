// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/inertial/camera_turn.hpp"
#include "services/slam/core/inertial/inertial_filter.hpp"
#include "services/slam/core/inertial/wheel_stream.hpp"

namespace rtd::slam {

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
  /// Its expected pose if what was learnt before the last believe() may be wrong: that doubt grows with the time since.
  /// Only an IMU learns.
  std::optional<PredictedPose> doubted() const;
  /// A pose that is believed contradicts the expected one: what was learnt was wrong.
  void doubt();
  /// As correct(), by a pose that needs no support by the prior.
  void believe(const PredictedPose& measured);
  /// The camera was found elsewhere than it was expected.
  void relocate(const PredictedPose& measured);
  /// The pose of the frame in work is claimed as expected; what an IMU says of it later is a correction.
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
