// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/camera/core/synthetic/geometry.hpp"

namespace rtd::camera::synthetic {

/// The part of the floor where movers walk, world frame: x within +-reach_x_m, y around center_y_m. In front of
/// CameraRoom.
struct WalkArea {
  float center_y_m = 0.45F, reach_x_m = 1.4F, reach_y_m = 0.45F;
};

/// A closed, smooth, never repeating path over a WalkArea.
class FloorPath {
 public:
  /// `speed_m_s`: the highest along x.
  FloorPath(std::uint64_t seed, const WalkArea& area, float speed_m_s);
  Eigen::Vector2f position_m(double t_s) const;
  float heading_rad(double t_s) const;  ///< direction of travel, from x towards y

 private:
  WalkArea area_;
  float rate_x_, rate_y_, phase_x_, phase_y_;  ///< rad/s, rad
};

/// A figure of ellipsoids (head, torso, hips, arms, legs) that walks with swinging limbs.
class Person {
 public:
  /// Adds the person's textures to `textures`.
  Person(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const;

 private:
  FloorPath path_;
  float height_scale_, step_rate_rad_s_;
  int skin_texture_, shirt_texture_, trousers_texture_;
};

/// A box that is carried about, bobbing and turning: of no class that a detector knows.
class CarriedBox {
 public:
  CarriedBox(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const;

 private:
  FloorPath path_;
  Eigen::Vector3f size_m_;
  float height_m_, turn_rate_rad_s_, phase_rad_;
  int texture_;
};

}  // namespace rtd::camera::synthetic
