// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>

#include "common/camera/frame_source.hpp"

namespace rtd::camera::synthetic {

/// The true pose of the camera at a time, s.
using PathOfCamera = std::function<Eigen::Isometry3d(double t_s)>;

/// An IMU in the optical frame of a camera that moves on a path: a cheap MEMS by default, with white noise, a constant
/// bias that the seed draws and one that wanders. A reading shows the mean over its period, and is a pure function of
/// seed and index.
class SyntheticImu {
 public:
  struct Options {
    double rate_hz = 200;
    double gyro_noise_rad_s_rthz = 0.01 * 0.017453292519943295;  ///< 0.01 degrees per second and root Hz
    double accel_noise_m_s2_rthz = 150e-6 * 9.80665;             ///< 150 ug per root Hz
    double gyro_bias_rad_s = 0.5 * 0.017453292519943295;         ///< length of the constant bias
    double accel_bias_m_s2 = 0.05;
    double gyro_wander_rad_s = 0.003 * 0.017453292519943295;  ///< amplitude of the bias that wanders: 10 degrees/h
    double accel_wander_m_s2 = 0.0004;                        ///< 40 ug
  };

  SyntheticImu(PathOfCamera path, const Options& options, std::uint64_t seed);
  /// Reading `index` is of time index / rate_hz.
  ImuReading reading(std::int64_t index) const;
  const Options& options() const { return options_; }
  /// What the constant biases are.
  const Eigen::Vector3d& gyro_bias_rad_s() const { return gyro_bias_rad_s_; }
  const Eigen::Vector3d& accel_bias_m_s2() const { return accel_bias_m_s2_; }

 private:
  PathOfCamera path_;
  Options options_;
  std::uint64_t seed_;
  Eigen::Vector3d gyro_bias_rad_s_, accel_bias_m_s2_, phase_rad_;
};

/// Wheels below a camera that drives level: the base is on the floor, straight below the camera, x where it looks. The
/// radius of the wheels and their distance are wrong by a little, and they slip.
class SyntheticWheels {
 public:
  static constexpr double kRate_hz = 50;

  SyntheticWheels(PathOfCamera path, std::uint64_t seed);
  /// The reading after the last one; the first is of time 0.
  WheelReading next();
  double next_s() const { return static_cast<double>(index_) / kRate_hz; }

 private:
  PathOfCamera path_;
  std::uint64_t seed_;
  double way_factor_, turn_factor_;
  std::int64_t index_ = 0;
  Eigen::Isometry3d T_odom_base_ = Eigen::Isometry3d::Identity();
};

/// Where the optical frame of that camera is in its base: level, `height_m` above the floor.
Eigen::Isometry3d T_base_level_camera(double height_m);

}  // namespace rtd::camera::synthetic
