// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/camera/synthetic/camera_path.hpp"
#include "common/camera/synthetic/figure.hpp"
#include "common/camera/synthetic/geometry.hpp"
#include "common/camera/synthetic/texture.hpp"

/// Movers with a plot, for what dynamic SLAM finds hard.
namespace rtd::camera::synthetic {

/// Something that moves, or may. A pure function of the time; adds the same objects in the same order every time.
class Actor {
 public:
  virtual ~Actor() = default;
  virtual void append_to(Geometry& geometry, double t_s) const = 0;
};

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

/// A person who walks about with swinging limbs.
class Walker final : public Actor {
 public:
  /// Adds the person's textures to `textures`.
  Walker(std::uint64_t seed, const WalkArea& area, FigureLook look, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const override;

 private:
  FloorPath path_;
  Figure figure_;
};

/// A box of no class that a detector knows.
struct MovingBox {
  Eigen::Vector3f size_m = Eigen::Vector3f::Ones();
  int texture = 0;  ///< index
  /// Adds an object of class "box" with the middle of its lower side at `position_m`, turned about the vertical.
  void append_to(Geometry& geometry, const Eigen::Vector3f& position_m, float turned_rad) const;
};
/// A random texture that is large enough for a box; its index.
int paint_box(SeededRandom& random, const Eigen::Vector3f& size_m, std::vector<Texture>& textures);

/// A box that is carried about, bobbing and turning.
class CarriedBox final : public Actor {
 public:
  CarriedBox(std::uint64_t seed, const WalkArea& area, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const override;

 private:
  FloorPath path_;
  MovingBox box_;
  float height_m_, turn_rate_rad_s_, phase_rad_;
};

/// A person who sits on a chair, rises, walks about and stops. The chair (class "chair") never moves.
class Sitter final : public Actor {
 public:
  struct Habits {
    double sit_s;       ///< until rising
    double fidget_rad;  ///< amplitude of arms and head while at rest, 0 = like a statue
  };
  /// The chair stands where the camera looks most.
  Sitter(std::uint64_t seed, const CameraPath& camera, const Habits& habits, FigureLook look,
         std::vector<Texture>& textures);
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

/// A person in a wide coat who comes up to the camera, stays in front of it wherever it goes, and leaves again.
class Blocker final : public Actor {
 public:
  Blocker(std::uint64_t seed, const CameraPath& camera, FigureLook look, std::vector<Texture>& textures);
  void append_to(Geometry& geometry, double t_s) const override;

  static constexpr double kComesS = 1.5, kThereS = 3.0, kGoesS = 5.5, kGoneS = 7.0;

 private:
  CameraPath camera_;
  Figure figure_;
  float nearest_m_, farthest_m_;
};

/// A box that comes and goes along the camera's viewing axis.
class AxialBox final : public Actor {
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
class SlowBox final : public Actor {
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
