// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/motion_sensors.hpp"

#include <cmath>
#include <utility>

#include "common/camera/synthetic/texture.hpp"
#include "common/geometry/se3.hpp"

namespace rtd::camera::synthetic {
namespace {

const Eigen::Vector3d kGravity_m_s2(0, 0, -9.80665);
constexpr double kWanderRateRadS = 0.05;  // two minutes

Eigen::Vector3d normal_vector(SeededRandom& random) {
  const double x = static_cast<double>(random.normal()), y = static_cast<double>(random.normal());
  return {x, y, static_cast<double>(random.normal())};
}

std::uint64_t seed_of(std::uint64_t seed, std::int64_t index) {
  return SeededRandom(seed ^ (0x9E3779B97F4A7C15ULL * (static_cast<std::uint64_t>(index) + 1))).next();
}

}  // namespace

SyntheticImu::SyntheticImu(PathOfCamera path, const Options& options, std::uint64_t seed)
    : path_(std::move(path)), options_(options), seed_(seed ^ 0x1307ULL) {
  SeededRandom random(seed_);
  gyro_bias_rad_s_ = options.gyro_bias_rad_s * normal_vector(random).normalized();
  accel_bias_m_s2_ = options.accel_bias_m_s2 * normal_vector(random).normalized();
  phase_rad_ = normal_vector(random);
}

ImuReading SyntheticImu::reading(std::int64_t index) const {
  const double period_s = 1 / options_.rate_hz, t_s = static_cast<double>(index) * period_s, half_s = period_s / 2;
  const Eigen::Isometry3d before = path_(t_s - half_s), now = path_(t_s), after = path_(t_s + half_s);
  const Eigen::Vector3d acceleration =
      (before.translation() - 2 * now.translation() + after.translation()) / (half_s * half_s);
  const Eigen::Vector3d turn_rad = geometry::so3_log(before.linear().transpose() * after.linear());
  SeededRandom random(seed_of(seed_, index));
  const double root_hz = std::sqrt(options_.rate_hz);
  const Eigen::Vector3d wander = (phase_rad_.array() + kWanderRateRadS * t_s).sin();
  ImuReading reading;
  reading.stamp_ns = std::llround(t_s * 1e9);
  reading.gyro_rad_s = turn_rad / period_s + gyro_bias_rad_s_ + options_.gyro_wander_rad_s * wander +
                       options_.gyro_noise_rad_s_rthz * root_hz * normal_vector(random);
  reading.accel_m_s2 = now.linear().transpose() * (acceleration - kGravity_m_s2) + accel_bias_m_s2_ +
                       options_.accel_wander_m_s2 * wander.reverse() +
                       options_.accel_noise_m_s2_rthz * root_hz * normal_vector(random);
  return reading;
}

Eigen::Isometry3d T_base_level_camera(double height_m) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T.translation().z() = height_m;
  return T;
}

SyntheticWheels::SyntheticWheels(PathOfCamera path, std::uint64_t seed)
    : path_(std::move(path)), seed_(seed ^ 0x3EE15ULL) {
  constexpr double kRadiusError = 0.01, kTrackError = 0.02;
  SeededRandom random(seed_);
  way_factor_ = 1 + kRadiusError * static_cast<double>(random.normal());
  turn_factor_ = 1 + kTrackError * static_cast<double>(random.normal());
}

WheelReading SyntheticWheels::next() {
  constexpr double kSlip = 0.02, kSlipRadM = 0.01;  // of each step
  const double t_s = next_s(), step_s = 1 / kRate_hz;
  const Eigen::Isometry3d T_base_camera = T_base_level_camera(0);  // the height does not matter to a step
  const Eigen::Isometry3d T_before_now =
      T_base_camera * path_(t_s - step_s).inverse() * path_(t_s) * T_base_camera.inverse();
  SeededRandom random(seed_of(seed_, index_));
  const double way_m = T_before_now.translation().norm();
  const double slip = way_factor_ + kSlip * static_cast<double>(random.normal());
  const double turned_rad = std::atan2(T_before_now.linear()(1, 0), T_before_now.linear()(0, 0));
  const double turn_rad = turn_factor_ * turned_rad + kSlipRadM * way_m * static_cast<double>(random.normal());
  Eigen::Isometry3d T_step = Eigen::Isometry3d::Identity();
  T_step.translation() << slip * T_before_now.translation().x(), slip * T_before_now.translation().y(), 0;
  T_step.linear() = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  if (index_ > 0) T_odom_base_ = T_odom_base_ * T_step;
  ++index_;
  return {std::llround(t_s * 1e9), T_odom_base_, T_step.translation() / step_s, {0, 0, turn_rad / step_s}};
}

}  // namespace rtd::camera::synthetic
