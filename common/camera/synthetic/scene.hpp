// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/synthetic/actors.hpp"
#include "common/camera/synthetic/camera_path.hpp"
#include "common/camera/synthetic/geometry.hpp"
#include "common/camera/synthetic/sensor.hpp"

namespace rtd::camera::synthetic {

/// A corridor round a block: four sides, closed. World frame: z up, origin on the floor in the middle of the block.
struct CorridorPlan {
  double length_m = 34, depth_m = 20;    ///< of the rectangle in the middle of the corridor
  double width_m = 2.2, height_m = 2.5;  ///< of the corridor
  bool alike = false;                    ///< all sides (and, with an odd seed, their halves) have the same textures
  double speed_m_s = 2;
};

/// Walls, floor, ceiling and pilasters. Adds its textures to `textures`.
std::vector<Face> build_corridor(const CorridorPlan& plan, std::uint64_t seed, std::vector<Texture>& textures);

/// A walk along the middle of the corridor, round and round, looking ahead and early into each turn. Pure function of
/// the time.
class CorridorWalk {
 public:
  CorridorWalk(const CorridorPlan& plan, std::uint64_t seed);
  Eigen::Isometry3d T_world_camera(double t_s) const;
  /// Length of one round, m.
  double lap_m() const { return lap_m_; }

 private:
  /// On the floor: position and direction of the path, which grows by a full turn each round.
  struct Point {
    Eigen::Vector2d position_m;
    double heading_rad;
  };
  Point at(double way_m) const;
  double looking_rad(double way_m) const;

  CorridorPlan plan_;
  double lap_m_;
  std::array<double, 4> phases_rad_{};
};

/// Inner size of the room, m; the world frame's origin is on the floor in its middle, y towards the front wall.
inline constexpr float kRoomWidthM = 7.0F, kRoomDepthM = 6.4F, kRoomHeightM = 2.8F;

/// Movers with a plot.
enum class Plot { kNone, kSitter, kBlocker, kAxialBox, kSlowBoxes };

/// What a scene contains in addition to the room, or which corridor replaces the room.
struct SceneSpec {
  std::string name;
  int people = 0, boxes = 0;  ///< who walk about, which are carried about
  CameraMotion motion = CameraMotion::kHandHeld;
  WalkArea area = {};
  Plot plot = Plot::kNone;
  FigureLook figures = FigureLook::kPlain;
  std::uint64_t frames = 300;                 ///< of a clip, by default
  double fps = 30;                            ///< the same
  double range_m = 6;                         ///< depth is measured up to this distance
  double depth_noise = 1;                     ///< factor on its noise
  double focal_error = 0;                     ///< relative: the calibration's focal length against the true one
  double grain = 2;                           ///< standard deviation of the colour noise, grey levels
  double flicker = 0;                         ///< Lighting's unrest, [0, 1]
  double sit_s = 10;                          ///< a sitter rises after this time
  double fidget_rad = 0.03;                   ///< ... and moves arms and head so much meanwhile
  std::optional<CorridorPlan> corridor = {};  ///< instead of the room and its camera path
};

/// The scenes that have a name.
const std::vector<SceneSpec>& scene_catalog();

/// The world of a synthetic source; everything is a pure function of seed and time.
class Scene {
 public:
  Scene(const SceneSpec& spec, std::uint64_t seed);
  Geometry geometry_at(double t_s) const;
  Eigen::Isometry3d T_world_camera(double t_s) const {
    return walk_ ? walk_->T_world_camera(t_s) : camera_path_.T_world_camera(t_s);
  }
  const Lighting& lighting() const { return lighting_; }
  const std::vector<Texture>& textures() const { return textures_; }

 private:
  template <class M>
  void add(SeededRandom& random, const auto&... of_actor);
  void add_plot(const SceneSpec& spec, SeededRandom& random);

  std::vector<Texture> textures_;
  std::vector<Face> room_;
  std::vector<std::unique_ptr<Actor>> actors_;
  CameraPath camera_path_;
  std::optional<CorridorWalk> walk_;  ///< in a corridor, instead of the path
  Lighting lighting_;
};

}  // namespace rtd::camera::synthetic
