// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Movers with a plot, for what dynamic SLAM finds hard.
#pragma once

#include <cstdint>

#include "services/camera/core/synthetic/camera_path.hpp"
#include "services/camera/core/synthetic/movers.hpp"

namespace rtd::camera::synthetic {

/// Somebody who sits on a chair, rises, walks about and stops. The chair (class "chair") never moves.
class Sitter final : public Mover {
 public:
  struct Habits {
    double sit_s;       ///< until rising
    double fidget_rad;  ///< amplitude of arms and head while at rest, 0 = like a statue
  };
  /// The chair stands where the camera looks most.
  Sitter(std::uint64_t seed, const CameraPath& camera, const Habits& habits, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const override;

  static constexpr double kRiseS = 1.0, kWalkS = 5.0;

 private:
  Posture posture_at(double t_s) const;
  void append_chair(Geometry& geometry) const;

  Figure figure_;
  Habits habits_;
  Eigen::Vector2f feet_m_;  ///< while sitting
  float heading_rad_, turned_end_rad_, reach_x_m_, reach_y_m_;
  int chair_texture_;
};

/// Somebody in a wide coat who comes up to the camera, stands before it wherever it goes, and leaves again.
class Blocker final : public Mover {
 public:
  Blocker(std::uint64_t seed, const CameraPath& camera, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const override;

  static constexpr double kComesS = 1.5, kThereS = 3.0, kGoesS = 5.5, kGoneS = 7.0;

 private:
  CameraPath camera_;
  Figure figure_;
  float nearest_m_, farthest_m_;
};

/// A box that comes and goes along the camera's viewing axis.
class AxialBox final : public Mover {
 public:
  AxialBox(std::uint64_t seed, const CameraPath& camera, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const override;

 private:
  CameraPath camera_;
  MovingBox box_;
  float rate_rad_s_, phase_rad_, turned_rad_;
  Eigen::Vector3f offset_camera_m_;  ///< from the axis
};

/// A box that glides sideways at 2 to 5 cm/s, to and fro.
class SlowBox final : public Mover {
 public:
  SlowBox(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const override;

  static constexpr float kSlowestMS = 0.02F, kFastestMS = 0.05F;

 private:
  MovingBox box_;
  Eigen::Vector3f middle_m_;
  float speed_m_s_, phase_m_, turned_rad_;
};

}  // namespace rtd::camera::synthetic
