// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace rtd::camera::synthetic {

/// How the camera moves.
enum class CameraMotion {
  kHandHeld,  ///< swaying in the rear half of the room, looking to the front
  kWatching,  ///< the same sway, turning less: what is in the middle stays in view
  kTour,      ///< the same sway while turning round once a minute
  kRolling,   ///< the same sway while rolling about the viewing axis by up to 60 degrees either way
  kSteady,    ///< nearly at rest, as held by a person who stands: 2 cm, 1 degree
  kFixed,     ///< on a tripod
  kDriving,   ///< the same sway of a base that drives on the floor: level, at one height
};

/// A smooth, endless, hand-held-like path: slow sways of incommensurate periods and a small tremor. At most about
/// 0.5 m/s and 0.5 rad/s; never leaves kCameraRoom. Pure function of the time.
class CameraPath {
 public:
  CameraPath(CameraMotion motion, std::uint64_t seed);
  /// World frame: z up, origin on the floor in the middle of the room. Camera frame optical.
  Eigen::Isometry3d T_world_camera(double t_s) const;

 private:
  /// amplitude * sin(rate * t + phase) and a tremor on top
  struct Sway {
    double amplitude, rate_rad_s, phase_rad, second_phase_rad, tremor_phase_rad;
    double at(double t_s) const;
  };
  CameraMotion motion_;
  std::array<Sway, 6> sways_{};  ///< x y z (m), yaw pitch roll (rad)
};

/// R_world_camera of an optical frame that looks along (sin yaw, cos yaw) and up by the pitch, then rolls.
Eigen::Matrix3d level_camera_rotation(double yaw_rad, double pitch_rad, double roll_rad);

/// The box that the camera centre stays in, world frame, m: nothing else may stand there.
struct CameraRoom {
  static constexpr double kMinX = -1.2, kMaxX = 1.2, kMinY = -2.1, kMaxY = -0.9, kMinZ = 1.0, kMaxZ = 1.6;
};

}  // namespace rtd::camera::synthetic
