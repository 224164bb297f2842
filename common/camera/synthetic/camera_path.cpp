// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/camera_path.hpp"

#include <cmath>

#include "common/camera/synthetic/texture.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr double kSecondShare = 0.3;    ///< of the amplitude, in a faster sway
constexpr double kSecondRate = 2.618;   ///< times the rate: never in step with the first
constexpr double kTremorShare = 0.004;  ///< of the amplitude
constexpr double kTremorRateRadS = 23.0;
constexpr double kWatchingYawShare = 0.4;
constexpr double kSteadyShare = 0.02;
constexpr double kRollingRad = 0.8;  ///< with the second sway up to 60 degrees
constexpr double kTurnRateRadS = kTwoPi / 60.0;
constexpr double kMeanYM = -1.5, kMeanZM = 1.3, kMeanPitchRad = -0.14;

constexpr std::size_t kZ = 2, kYaw = 3, kPitch = 4, kRoll = 5;  ///< indices of Sway
struct Axis {
  double amplitude, rate_rad_s;
};
constexpr std::array<Axis, 6> kAxes = {
    {{0.85, 0.37}, {0.40, 0.43}, {0.14, 0.61}, {0.42, 0.29}, {0.10, 0.47}, {0.05, 0.71}}};

}  // namespace

Eigen::Matrix3d level_camera_rotation(double yaw_rad, double pitch_rad, double roll_rad) {
  const Eigen::Vector3d forward(std::sin(yaw_rad) * std::cos(pitch_rad), std::cos(yaw_rad) * std::cos(pitch_rad),
                                std::sin(pitch_rad));
  const Eigen::Vector3d right(std::cos(yaw_rad), -std::sin(yaw_rad), 0);
  Eigen::Matrix3d R_world_level;
  R_world_level << right, forward.cross(right), forward;
  return R_world_level * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

double CameraPath::Sway::at(double t_s) const {
  return amplitude * (std::sin(rate_rad_s * t_s + phase_rad) +
                      kSecondShare * std::sin(kSecondRate * rate_rad_s * t_s + second_phase_rad) +
                      kTremorShare * std::sin(kTremorRateRadS * t_s + tremor_phase_rad));
}

CameraPath::CameraPath(CameraMotion motion, std::uint64_t seed) : motion_(motion) {
  SeededRandom random(seed ^ 0xCA3E7AULL);
  const auto phase = [&random] { return kTwoPi * static_cast<double>(random.unit()); };
  for (std::size_t i = 0; i < sways_.size(); ++i) {
    const double first = phase(), second = phase();
    sways_[i] = {kAxes[i].amplitude, kAxes[i].rate_rad_s, first, second, phase()};
  }
  if (motion == CameraMotion::kWatching) sways_[kYaw].amplitude *= kWatchingYawShare;
  if (motion == CameraMotion::kRolling) sways_[kRoll].amplitude = kRollingRad;
  if (motion == CameraMotion::kDriving) sways_[kZ].amplitude = sways_[kPitch].amplitude = sways_[kRoll].amplitude = 0;
  if (motion == CameraMotion::kSteady) {
    for (Sway& sway : sways_) sway.amplitude *= kSteadyShare;
  }
}

Eigen::Isometry3d CameraPath::T_world_camera(double t_s) const {
  if (motion_ == CameraMotion::kFixed) t_s = 0;
  const auto& [x, y, z, yaw, pitch, roll] = sways_;
  const double turned_rad = motion_ == CameraMotion::kTour ? kTurnRateRadS * t_s : 0.0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(x.at(t_s), kMeanYM + y.at(t_s), kMeanZM + z.at(t_s));
  const double mean_pitch_rad = motion_ == CameraMotion::kDriving ? 0.0 : kMeanPitchRad;
  T.linear() = level_camera_rotation(yaw.at(t_s) + turned_rad, mean_pitch_rad + pitch.at(t_s), roll.at(t_s));
  return T;
}

}  // namespace rtd::camera::synthetic
