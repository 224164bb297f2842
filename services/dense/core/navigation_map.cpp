// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/navigation_map.hpp"

#include <algorithm>
#include <vector>

namespace rtd::dense {
namespace {

constexpr std::size_t kMovesPerFrame = 4;  // images that follow a correction with each new one
constexpr int kNoiseCells = 2;             // readings of a surface reach so far
constexpr std::size_t kSpeckCells = 6;

/// The voxels of the dense map in a cell.
struct Surface {
  float weight = 0;
  int points = 0, sightings = 0;  ///< frames that saw the one that was seen most
  bool operator==(const Surface&) const = default;
};

/// A cell before or behind a surface that has nearly all of the weight.
bool beside_surface(const CellBlocks<Surface>& surfaces, const Eigen::Vector3i& cell, float weight, double share) {
  for (int y = -kNoiseCells; y <= kNoiseCells; ++y) {
    for (int x = -kNoiseCells; x <= kNoiseCells; ++x) {
      const float other = surfaces.value(cell + Eigen::Vector3i(x, y, 0)).weight;
      if (static_cast<double>(weight) < share * static_cast<double>(other)) return true;
    }
  }
  return false;
}

/// A cell in the air that hangs together with few others.
bool is_speck(const CellBlocks<Space>& cells, const Eigen::Vector3i& cell) {
  std::vector<Eigen::Vector3i> found = {cell};
  for (std::size_t next = 0; next < found.size() && found.size() < kSpeckCells; ++next) {
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i other = found[next] + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      if (cells.value(other) == Space::kOccupied && std::ranges::find(found, other) == found.end())
        found.push_back(other);
    }
  }
  return found.size() < kSpeckCells;
}

void remove_specks(CellBlocks<Space>& cells) {
  std::vector<Eigen::Vector3i> specks;
  cells.for_each([&](const Eigen::Vector3i& cell, Space space) {
    if (space == Space::kOccupied && is_speck(cells, cell)) specks.push_back(cell);
  });
  for (const Eigen::Vector3i& cell : specks) cells.set(cell, Space::kUnknown);
}

}  // namespace

NavigationMap::NavigationMap(const NavigationConfig& config, const Eigen::Vector3d& up)
    : config_(config), R_grid_map_(occupancy::grid_rotation(up)), space_(config.space, R_grid_map_) {}

void NavigationMap::integrate(const vision::RgbdImage& image, const Eigen::Isometry3d& T_map_camera) {
  space_.follow_corrections(kMovesPerFrame);
  space_.add(image, T_map_camera);
}

Volume NavigationMap::volume(StaticMap& occupied) {
  Volume volume{config_.space.cell_m, {}};
  space_.for_each(config_.min_sightings, [&](const Eigen::Vector3i& cell) { volume.cells.set(cell, Space::kFree); });
  CellBlocks<Surface> surfaces;
  FloorFinder floor;
  const Eigen::Matrix3f R_grid_map = R_grid_map_.cast<float>();
  const auto cell_m = static_cast<float>(volume.cell_m);
  occupied.for_each_believed([&](const Voxel& voxel) {
    const Eigen::Vector3f p = R_grid_map * voxel.p_world;
    floor.add(static_cast<double>(p.z()));
    Surface* surface = surfaces.cell((p / cell_m).array().floor().cast<int>());
    if (surface == nullptr) return;
    surface->weight += voxel.weight;
    ++surface->points;
    surface->sightings = std::max(surface->sightings, int{voxel.sightings});
  });
  surfaces.for_each([&](const Eigen::Vector3i& cell, const Surface& surface) {
    // What appears where space was free may be a person whom the masks missed for a moment.
    const bool sure = surface.sightings >= config_.min_frames_in_free || volume.cells.value(cell) != Space::kFree;
    if (sure && surface.points >= config_.min_points &&
        !beside_surface(surfaces, cell, surface.weight, config_.min_weight_share))
      volume.cells.set(cell, Space::kOccupied);
  });
  remove_specks(volume.cells);
  floor_m_ = config_.find_floor ? floor.floor_m(space_.lowest_camera_m()) : config_.floor_m;
  return volume;
}

std::optional<NavigationGrid> NavigationMap::grid(StaticMap& occupied) {
  return grid(volume(occupied));
}

std::optional<NavigationGrid> NavigationMap::grid(const Volume& volume) const {
  if (!floor_m_) return std::nullopt;
  return project(volume, *floor_m_, config_.heights, static_cast<std::size_t>(config_.max_cells));
}

}  // namespace rtd::dense
