// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "common/camera/synthetic/geometry.hpp"

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

}  // namespace rtd::camera::synthetic
