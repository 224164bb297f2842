// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/occupancy/navigation_grid.hpp"
#include "services/dense/core/free_space.hpp"
#include "services/dense/core/static_map.hpp"

namespace rtd::dense {

using occupancy::FloorFinder;
using occupancy::NavigationGrid;
using occupancy::RobotHeights;

struct NavigationConfig {
  FreeSpaceConfig space;
  RobotHeights heights;
  bool find_floor = true;
  double floor_m = 0;
  int min_sightings = 2;
  int min_points = 2;
  int min_frames_in_free = 20;
  double min_weight_share = 0.25;
  int max_cells = 16'000'000;

  void bind(auto& binder) {
    space.bind(binder);
    heights.bind(binder);
    binder.field("find_floor", find_floor, "look for the floor; false: it is at floor_m");
    binder.field("floor_m", floor_m, {-1000.0, 1000.0}, "height of the floor in the map");
    binder.field("min_sightings", min_sightings, {1, 1000}, "so many kept images must have looked through a free cell");
    binder.field("min_points", min_points, {1, 255}, "an occupied cell holds so many voxels of the dense map");
    binder.field("min_frames_in_free", min_frames_in_free, {1, 1000},
                 "where space was free, something must be seen in so many frames to occupy it");
    binder.field("min_weight_share", min_weight_share, {0.0, 1.0},
                 "a cell with less of the weight of another one, two cells aside at most, is noise of its surface");
    binder.field("max_cells", max_cells, {100, 100'000'000}, "of the grid, a byte each; what lies outside is cropped");
  }
};

/// What a robot needs to know of a place: where it can drive, and what space is free and occupied. Occupied is what the
/// static map believes, free is what its images looked through. docs/theory/dense_map.md. One thread.
class NavigationMap {
 public:
  /// `up`: in the map frame. Throws std::invalid_argument when it has no direction.
  NavigationMap(const NavigationConfig& config, const Eigen::Vector3d& up);

  /// Every event and every fused frame that the static map gets.
  void update(const msg::KeyframeEvent& event) { space_.update(event); }
  void integrate(const vision::RgbdImage& image, const Eigen::Isometry3d& T_map_camera);
  void clear() { space_.clear(); }

  /// Occupied, free and unknown cells, after all corrections that were followed.
  Volume volume(StaticMap& occupied);
  /// Empty as long as the floor is unknown.
  std::optional<NavigationGrid> grid(StaticMap& occupied);
  /// The same from a volume just made by volume().
  std::optional<NavigationGrid> grid(const Volume& volume) const;
  /// Moves at most `most` kept images to where slam's corrections have put their keyframes, as integrate() does with a
  /// few. True when all are there.
  bool follow_corrections(std::size_t most = SIZE_MAX) { return space_.follow_corrections(most); }

  const FreeSpace& space() const { return space_; }
  const Eigen::Matrix3d& R_grid_map() const { return R_grid_map_; }

 private:
  NavigationConfig config_;
  Eigen::Matrix3d R_grid_map_;
  FreeSpace space_;
  std::optional<double> floor_m_;
};

}  // namespace rtd::dense
