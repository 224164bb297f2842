// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>

#include "common/msg/stamps.hpp"

namespace rtd::inertial {

inline double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  return msg::minus_s(to_ns, from_ns);
}

/// What an IMU measured, in its own axes. At rest the accelerometer shows 9.81 m/s2 upwards.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_m_s2 = Eigen::Vector3d::Zero();
};

struct ImuBias {
  Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_m_s2 = Eigen::Vector3d::Zero();
};

/// Densities of an IMU's white noise.
struct ImuNoise {
  double gyro_rad_s_rthz = 0;  ///< rad/s per root Hz
  double accel_m_s2_rthz = 0;  ///< m/s2 per root Hz
};

/// What the IMU says about the motion between two moments, without knowing pose, velocity or gravity at the first one.
/// Forster et al., On-Manifold Preintegration (2017); docs/theory/inertial.md Eq. (2) to (5).
class Preintegration {
 public:
  using Matrix9d = Eigen::Matrix<double, 9, 9>;
  using Matrix96d = Eigen::Matrix<double, 9, 6>;

  explicit Preintegration(const ImuBias& bias, const ImuNoise& noise) : bias_(bias), noise_(noise) {}

  /// The IMU measured this, on average, for `dt_s`.
  void add(const Eigen::Vector3d& gyro_rad_s, const Eigen::Vector3d& accel_m_s2, double dt_s);

  double duration_s() const { return duration_s_; }
  const Eigen::Matrix3d& rotation() const { return rotation_; }  ///< R_first_last
  const Eigen::Vector3d& velocity() const { return velocity_; }  ///< m/s, axes of the first moment, without gravity
  const Eigen::Vector3d& position() const { return position_; }  ///< m, the same
  /// Of (rotation in the axes of the last moment, velocity, position).
  const Matrix9d& covariance() const { return covariance_; }
  /// Derivative of the same by (gyro bias, accel bias).
  const Matrix96d& bias_jacobian() const { return bias_jacobian_; }

 private:
  ImuBias bias_;
  ImuNoise noise_;
  double duration_s_ = 0;
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  Matrix9d covariance_ = Matrix9d::Zero();
  Matrix96d bias_jacobian_ = Matrix96d::Zero();
};

/// Why samples were left out.
struct ImuCounters {
  std::uint64_t taken = 0;
  std::uint64_t invalid = 0;       ///< not finite, or more than any IMU measures
  std::uint64_t out_of_order = 0;  ///< older than the sample before
  std::uint64_t doubled = 0;       ///< the same stamp again
  std::uint64_t gaps = 0;          ///< pauses longer than ImuStream::kMaxGap_s
  std::uint64_t clock_jumps = 0;   ///< stamps that went back or ahead for good
  std::uint64_t overflowed = 0;    ///< given up because no frame came
  std::uint64_t dropped() const { return invalid + out_of_order + doubled + overflowed; }
};

/// The newest samples of an IMU, in the order of their stamps. Takes what a topic delivers and leaves out what cannot
/// be used. Not thread-safe.
class ImuStream {
 public:
  static constexpr double kMaxGap_s = 0.1;   ///< nothing is known of the motion in a longer pause
  static constexpr std::size_t kMax = 8192;  ///< 20 s at 400 Hz

  void add(const ImuSample& sample);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }
  std::int64_t newest_ns() const { return samples_.empty() ? 0 : samples_.back().stamp_ns; }
  const ImuCounters& counters() const { return counters_; }

  /// Empty when the samples have a pause in the span, or do not cover it but for kMaxGap_s at its ends.
  std::optional<Preintegration> integrate(std::int64_t from_ns, std::int64_t to_ns, const ImuBias& bias,
                                          const ImuNoise& noise) const;
  /// Forgets what is older, but for one sample to interpolate with.
  void forget_before(std::int64_t stamp_ns);

  /// The mean of both measurements over the longest rest of at least `min_s` that ends with the newest sample; empty
  /// when the IMU moves. At rest: docs/theory/inertial.md Eq. (13).
  std::optional<ImuSample> rest(double min_s) const;

 private:
  bool follows(const ImuSample& sample);

  std::deque<ImuSample> samples_;
  int strays_ = 0;  ///< samples in a row whose stamps are before the newest one
  ImuCounters counters_;
};

/// The up direction in the IMU's axes, of length 1, of an IMU that has rested for `min_s`; empty when it has not.
std::optional<Eigen::Vector3d> up_at_rest(const ImuStream& samples, double min_s);

/// How the camera has turned between two moments: a vector in the axes of the later one becomes one in those of the
/// earlier. The covariance is of a small turn in the axes of the later moment, rad^2.
struct CameraTurn {
  Eigen::Matrix3d R_earlier_later = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

/// What is not known of a gyroscope.
struct GyroscopeErrors {
  Eigen::Matrix3d bias_covariance = Eigen::Matrix3d::Zero();  ///< of what is left of the bias, (rad/s)^2, IMU's axes
  double scale_error = 0;                                     ///< of it and its clock, share of a turn
};

/// Of the camera to which the IMU is fixed. `R_camera_imu`: from the IMU's axes to the optical frame.
/// docs/theory/dynamic_points.md Eq. (15).
CameraTurn turn_of_camera(const Preintegration& motion, const Eigen::Matrix3d& R_camera_imu,
                          const GyroscopeErrors& errors);

}  // namespace rtd::inertial
