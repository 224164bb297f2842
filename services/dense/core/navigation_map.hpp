// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/occupancy/navigation_grid.hpp"
#include "common/occupancy/volume.hpp"
#include "services/dense/core/depth_view.hpp"
#include "services/dense/core/static_map.hpp"

namespace rtd::dense {

using occupancy::CellBlocks;
using occupancy::Space;
using occupancy::Volume;

/// What is kept of the depth images of the past, and how long.
struct FreeSpaceConfig {
  double cell_m = 0.05;
  double max_range_m = 6.0;
  double margin_m = 0.05;
  double margin_sigmas = 3.0;
  int max_scans = 6000;
  int max_blocks = 12'000;

  void bind(auto& binder) {
    binder.field("cell_m", cell_m, {0.01, 1.0}, "side of a cell of the grid and of the voxel map");
    binder.field("max_range_m", max_range_m, {0.5, 50.0}, "nothing is called free beyond this depth");
    binder.field("margin_m", margin_m, {0.0, 1.0}, "nothing is called free so close before a reading");
    binder.field("margin_sigmas", margin_sigmas, {0.0, 10.0}, "and so many standard deviations of depth");
    binder.field("max_scans", max_scans, {10, 1'000'000}, "decimated depth images kept, 10 kB each");
    binder.field("max_blocks", max_blocks, {10, 1'000'000},
                 "blocks of 16 x 16 x 16 cells, 8 kB each; at this number no new space becomes free");
  }
};

/// Cells of space that depth images looked through. Each kept image is a decimated one in which a pixel holds the depth
/// up to which all of its readings were free; a cell counts the images that saw through its centre. The sum is exact:
/// when slam moves a keyframe, its images are subtracted where they were and added where they are. A reading on
/// something that moves clears what is before it, and nothing behind it. docs/theory/dense_map.md Eq. (5).
/// Deterministic in the order of calls. One thread.
class FreeSpace {
 public:
  /// R_grid_map: `grid` has z up.
  FreeSpace(const FreeSpaceConfig& config, const Eigen::Matrix3d& R_grid_map);

  void update(const msg::KeyframeEvent& event);
  /// Keeps the image, unless its viewpoint is known well. Image and pose are usable (StaticMap::integrate() said so).
  void add(const vision::RgbdImage& image, const Eigen::Isometry3d& T_map_camera);
  /// Moves at most `most` images to where slam's corrections have put their keyframes. True when all are there.
  bool follow_corrections(std::size_t most = SIZE_MAX);
  void clear();

  /// Calls visit(cell) for each cell that at least `sightings` images saw through.
  template <class Visit>
  void for_each(int sightings, Visit visit) const {
    counts_.for_each([&](const Eigen::Vector3i& cell, std::uint16_t count) {
      if (count >= sightings) visit(cell);
    });
  }
  std::size_t scans() const { return scans_.size(); }
  /// Of the images, along z of `grid`, m: nothing that the camera stood on is higher. Large before the first.
  double lowest_camera_m() const { return lowest_camera_m_; }
  bool full() const { return full_; }
  std::uint64_t moved_scans() const { return moved_; }

 private:
  struct Scan {
    std::int64_t stamp_ns = 0;
    AnchorId anchor = kNoAnchor;
    Eigen::Isometry3d T_anchor_camera, T_map_camera;  ///< the latter as it was added; both T_map_camera without anchor
    float fx = 1, fy = 1, cx = 0, cy = 0;             ///< of the decimated image
    int columns = 0, rows = 0;
    std::uint16_t farthest_mm = 0;
    std::vector<std::uint16_t> clear_mm;  ///< along z; 0 = unknown
  };
  struct Frustum;
  Scan decimate(const vision::RgbdImage& image);
  std::uint64_t viewpoint(const Eigen::Isometry3d& T_map_camera) const;
  void count(const Scan& scan, int change);
  void count_block(const Scan& scan, const Frustum& frustum, const Eigen::Vector3i& block, int change);
  Eigen::Isometry3d pose(const Scan& scan) const;

  FreeSpaceConfig config_;
  Eigen::Matrix3d R_grid_map_;
  geometry::DepthNoise noise_;
  PixelTable table_;
  KeyframePoses keyframes_;
  std::vector<Scan> scans_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> views_;  ///< scans by viewpoint, oldest first
  CellBlocks<std::uint16_t> counts_;
  std::size_t checked_ = 0;  ///< scans since the last correction that are where they belong
  double lowest_camera_m_ = 1e9;
  std::uint64_t moved_ = 0;
  bool full_ = false;
};

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
