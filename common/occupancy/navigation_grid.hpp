// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "common/occupancy/volume.hpp"

namespace rtd::occupancy {

/// Which heights above the floor matter to a robot.
struct RobotHeights {
  double min_height_m = 0.10;
  double max_height_m = 1.2;
  double clear_below_m = 0.25;

  void bind(auto& binder) {
    binder.field("min_height_m", min_height_m, {0.0, 1.0}, "what is not higher above the floor is floor");
    binder.field("max_height_m", max_height_m, {0.1, 10.0},
                 "of the robot: what is higher above the floor is no obstacle");
    binder.field("clear_below_m", clear_below_m, {0.05, 10.0},
                 "a cell is free when it was seen to be empty so close above the floor");
  }
};

/// A floor plan. Frame `grid`: z up. Cell (x, y) covers [x, x + 1) * cell_m from the origin, and likewise y.
struct NavigationGrid {
  static constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;  ///< as nav_msgs/OccupancyGrid has them
  double cell_m = 0.05;
  Eigen::Vector2i first = Eigen::Vector2i::Zero();  ///< cell of the corner, counted from the origin of `grid`
  int columns = 0, rows = 0;
  std::vector<std::int8_t> cells;  ///< row by row, from the lowest y
  double floor_m = 0;              ///< along z of `grid`
  bool cropped = false;            ///< more is known than there was room for

  /// Of such cells, all unknown; at most `max_cells` around the middle.
  static NavigationGrid unknown(Eigen::AlignedBox2i box, double cell_m, std::size_t max_cells);
  /// The box of its cells, inclusive.
  Eigen::AlignedBox2i extent() const { return {first, first + Eigen::Vector2i(columns - 1, rows - 1)}; }
  /// Occupied stays, and so does what is free unless it is occupied. The cell must be of the grid.
  void mark(const Eigen::Vector2i& cell, std::int8_t value);
  Eigen::Vector2d origin_m() const { return cell_m * first.cast<double>(); }
  /// kUnknown outside.
  std::int8_t at(const Eigen::Vector2i& cell) const;
  bool operator==(const NavigationGrid&) const = default;
};

/// Rotation to `grid` from a frame in which `up` points up: none where that is z; else x stays as level as it can.
/// Throws std::invalid_argument for a vector that is not finite or too short.
Eigen::Matrix3d grid_rotation(const Eigen::Vector3d& up);

/// Finds the level of the floor: the lowest level with many points, below `below_m`.
class FloorFinder {
 public:
  void add(double z_m);
  /// Empty without points below.
  std::optional<double> floor_m(double below_m) const;

 private:
  static constexpr double kBinM = 0.01, kFarthestM = 50;
  std::vector<std::uint32_t> bins_ = std::vector<std::uint32_t>(static_cast<std::size_t>(2 * kFarthestM / kBinM));
};

/// Occupied where something stands between the heights; else free where the space just above the floor was seen to be
/// free. At most `max_cells` around the middle.
NavigationGrid project(const Volume& volume, double floor_m, const RobotHeights& heights, std::size_t max_cells);

/// Binary PGM as map_server reads it: 0 occupied, 254 free, 205 unknown, the highest y first.
void write_pgm(std::ostream& out, const NavigationGrid& grid);
/// The YAML file next to it.
std::string map_yaml(const NavigationGrid& grid, const std::string& image);

}  // namespace rtd::occupancy
