// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <unordered_map>
#include <vector>

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

}  // namespace rtd::dense
