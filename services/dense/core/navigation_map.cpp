// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/navigation_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/msg/stamps.hpp"

namespace rtd::dense {
namespace {

constexpr int kColumns = 80, kStep = 2;  // of a decimated image; every second reading along both axes is looked at
constexpr float kMmPerM = 1000, kNearM = 0.05F;
constexpr std::size_t kScansOfView = 2;  // kept of a viewpoint
constexpr std::int64_t kRenewNs = 1'000'000'000;
constexpr double kViewM = 0.25, kViewRad = 0.3;         // one viewpoint
constexpr double kMovedCells = 0.4, kMovedRad = 0.005;  // less is no correction
constexpr std::size_t kChecksAtOnce = 1000;

}  // namespace

/// A scan's camera in cells of `grid`.
struct FreeSpace::Frustum {
  Eigen::Matrix3f R_camera_grid;
  Eigen::Vector3f p_camera;  ///< the origin of `grid` in the camera, m
  float farthest_m = 0;
  std::array<Eigen::Vector3f, 4> sides;  ///< unit normals, inwards, camera frame
};

FreeSpace::FreeSpace(const FreeSpaceConfig& config, const Eigen::Matrix3d& R_grid_map)
    : config_(config), R_grid_map_(R_grid_map) {}

void FreeSpace::update(const msg::KeyframeEvent& event) {
  const Eigen::Isometry3d* known = keyframes_.pose(event.keyframe_id);
  const Eigen::Isometry3d T_map_removed = known == nullptr ? Eigen::Isometry3d::Identity() : *known;
  const auto removed = keyframes_.update(event);
  checked_ = 0;
  if (!removed) return;
  const Eigen::Isometry3d* T_map_follows = keyframes_.pose(removed->follows);
  for (Scan& scan : scans_) {
    if (scan.anchor != removed->keyframe) continue;
    const Eigen::Isometry3d T_map_camera = T_map_removed * scan.T_anchor_camera;
    scan.anchor = removed->follows;
    scan.T_anchor_camera = T_map_follows == nullptr ? T_map_camera : T_map_follows->inverse() * T_map_camera;
  }
}

void FreeSpace::add(const vision::RgbdImage& image, const Eigen::Isometry3d& T_map_camera) {
  std::vector<std::uint32_t>& view = views_[viewpoint(T_map_camera)];
  const bool known = view.size() >= kScansOfView;
  if (known && msg::minus_ns(image.stamp_ns, scans_[view.back()].stamp_ns) < kRenewNs) return;
  full_ = full_ || (!known && scans_.size() >= static_cast<std::size_t>(config_.max_scans));
  if (!known && scans_.size() >= static_cast<std::size_t>(config_.max_scans)) return;
  Scan scan = decimate(image);
  scan.stamp_ns = image.stamp_ns;
  scan.anchor = keyframes_.newest();
  const Eigen::Isometry3d* T_map_anchor = keyframes_.pose(scan.anchor);
  scan.T_map_camera = T_map_camera;
  scan.T_anchor_camera = T_map_anchor == nullptr ? T_map_camera : T_map_anchor->inverse() * T_map_camera;
  lowest_camera_m_ = std::min(lowest_camera_m_, (R_grid_map_ * T_map_camera.translation()).z());
  count(scan, 1);
  if (!known) {
    view.push_back(static_cast<std::uint32_t>(scans_.size()));
    scans_.push_back(std::move(scan));
    return;
  }
  count(scans_[view.front()], -1);
  scans_[view.front()] = std::move(scan);
  std::ranges::rotate(view, view.begin() + 1);
}

bool FreeSpace::follow_corrections(std::size_t most) {
  const std::size_t until = most == SIZE_MAX ? scans_.size() : std::min(scans_.size(), checked_ + kChecksAtOnce);
  for (; checked_ < until; ++checked_) {
    Scan& scan = scans_[checked_];
    const Eigen::Isometry3d T_map_camera = pose(scan), moved = scan.T_map_camera.inverse() * T_map_camera;
    const double turned_rad = Eigen::AngleAxisd(moved.linear()).angle();
    if (moved.translation().norm() < kMovedCells * config_.cell_m && turned_rad < kMovedRad) continue;
    if (most == 0) return false;
    --most;
    count(scan, -1);
    scan.T_map_camera = T_map_camera;
    count(scan, 1);
    ++moved_;
  }
  return checked_ == scans_.size();
}

void FreeSpace::clear() {
  keyframes_.clear();
  scans_.clear();
  views_.clear();
  counts_.clear();
  checked_ = 0;
  lowest_camera_m_ = 1e9;
  full_ = false;
}

Eigen::Isometry3d FreeSpace::pose(const Scan& scan) const {
  const Eigen::Isometry3d* T_map_anchor = keyframes_.pose(scan.anchor);
  return T_map_anchor == nullptr ? scan.T_anchor_camera : *T_map_anchor * scan.T_anchor_camera;
}

/// A cube of positions and a range of directions.
std::uint64_t FreeSpace::viewpoint(const Eigen::Isometry3d& T_map_camera) const {
  const Eigen::Vector3d at = T_map_camera.translation() / kViewM, along = R_grid_map_ * T_map_camera.linear().col(2);
  const double yaw = std::atan2(along.y(), along.x()), pitch = std::asin(std::clamp(along.z(), -1.0, 1.0));
  std::uint64_t key = 0;
  for (const double value : {at.x(), at.y(), at.z()}) {
    key = key << 16 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value))) & 0xFFFF);
  }
  for (const double angle : {yaw, pitch}) {
    key = key << 8 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(angle / kViewRad))) & 0xFF);
  }
  return key;
}

/// Eq. (6): each pixel is as near as the nearest of its readings, and unknown where fewer than half are measured.
FreeSpace::Scan FreeSpace::decimate(const vision::RgbdImage& image) {
  table_.fit(image.camera);
  const auto& p = image.camera.parameters();
  Scan scan;
  scan.columns = kColumns;
  const float side_px = static_cast<float>(p.width) / static_cast<float>(kColumns);
  scan.rows = static_cast<int>(std::ceil(static_cast<float>(p.height) / side_px));
  const auto ratio = static_cast<double>(side_px);
  scan.fx = static_cast<float>(p.fx / ratio);
  scan.fy = static_cast<float>(p.fy / ratio);
  scan.cx = static_cast<float>((p.cx + 0.5) / ratio);
  scan.cy = static_cast<float>((p.cy + 0.5) / ratio);
  const auto pixels = static_cast<std::size_t>(scan.columns * scan.rows);
  std::vector<std::uint16_t> nearest(pixels, std::numeric_limits<std::uint16_t>::max()), looked(pixels),
      measured(pixels);
  for (int row = 0; row < p.height; row += kStep) {
    const auto* depth = image.depth.ptr<std::uint16_t>(row);
    for (int column = 0; column < p.width; column += kStep) {
      const Eigen::Vector2f at = (table_.undistorted(row * p.width + column).array() + 0.5F) / side_px;
      if (!(at.x() >= 0 && at.y() >= 0)) continue;
      const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
      if (x >= scan.columns || y >= scan.rows) continue;
      const auto pixel = static_cast<std::size_t>(y * scan.columns + x);
      ++looked[pixel];
      if (depth[column] == 0) continue;
      ++measured[pixel];
      nearest[pixel] = std::min(nearest[pixel], depth[column]);
    }
  }
  scan.clear_mm.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (measured[i] == 0 || 2 * measured[i] < looked[i]) continue;
    const double depth_m = nearest[i] * image.depth_scale_m;
    const double margin_m = std::max(config_.margin_m, config_.margin_sigmas * noise_.sigma_m(depth_m));
    const double clear_m = std::clamp(depth_m - margin_m, 0.0, config_.max_range_m);
    scan.clear_mm[i] = static_cast<std::uint16_t>(std::min(clear_m * kMmPerM, 65'000.0));
    scan.farthest_mm = std::max(scan.farthest_mm, scan.clear_mm[i]);
  }
  return scan;
}

/// Adds `change` to the cells that the scan sees through.
void FreeSpace::count(const Scan& scan, int change) {
  constexpr int kSide = CellBlocks<std::uint16_t>::kSide;
  const auto block_m = static_cast<float>(kSide * config_.cell_m);
  const Eigen::Isometry3f T_grid_camera(Eigen::Isometry3d(R_grid_map_ * scan.T_map_camera).cast<float>());
  const float x0 = -scan.cx / scan.fx, x1 = (static_cast<float>(scan.columns) - scan.cx) / scan.fx;
  const float y0 = -scan.cy / scan.fy, y1 = (static_cast<float>(scan.rows) - scan.cy) / scan.fy;
  Frustum frustum;
  const Eigen::Isometry3f T_camera_grid = T_grid_camera.inverse();
  frustum.R_camera_grid = T_camera_grid.linear();
  frustum.p_camera = T_camera_grid.translation();
  frustum.farthest_m = static_cast<float>(scan.farthest_mm) / kMmPerM;
  frustum.sides = {Eigen::Vector3f(1, 0, -x0), {-1, 0, x1}, {0, 1, -y0}, {0, -1, y1}};
  for (Eigen::Vector3f& side : frustum.sides) side.normalize();
  Eigen::AlignedBox3f box(T_grid_camera.translation());
  for (const float x : {x0, x1}) {
    for (const float y : {y0, y1}) box.extend(T_grid_camera * (frustum.farthest_m * Eigen::Vector3f(x, y, 1)));
  }
  const Eigen::Vector3i first = (box.min() / block_m).array().floor().cast<int>();
  const Eigen::Vector3i last = (box.max() / block_m).array().floor().cast<int>();
  for (int z = first.z(); z <= last.z(); ++z) {
    for (int y = first.y(); y <= last.y(); ++y) {
      for (int x = first.x(); x <= last.x(); ++x) count_block(scan, frustum, {x, y, z}, change);
    }
  }
}

void FreeSpace::count_block(const Scan& scan, const Frustum& frustum, const Eigen::Vector3i& block, int change) {
  constexpr int kSide = CellBlocks<std::uint16_t>::kSide;
  const auto cell_m = static_cast<float>(config_.cell_m);
  const Eigen::Vector3f first_m = cell_m * ((kSide * block).cast<float>().array() + 0.5F).matrix();
  const Eigen::Vector3f first = frustum.R_camera_grid * first_m + frustum.p_camera;
  const Eigen::Vector3f step_x = cell_m * frustum.R_camera_grid.col(0), step_y = cell_m * frustum.R_camera_grid.col(1);
  const Eigen::Vector3f step_z = cell_m * frustum.R_camera_grid.col(2);
  constexpr float kHalf = (kSide - 1) / 2.0F;
  const Eigen::Vector3f center = first + kHalf * (step_x + step_y + step_z);
  const float radius_m = std::sqrt(3.0F) * kHalf * cell_m;
  if (center.z() < -radius_m || center.z() > frustum.farthest_m + radius_m) return;
  for (const Eigen::Vector3f& side : frustum.sides) {
    if (side.dot(center) < -radius_m) return;
  }
  CellBlocks<std::uint16_t>::Block* counts = counts_.find(block);
  for (int i = 0; i < kSide * kSide; ++i) {
    Eigen::Vector3f p = first + static_cast<float>(i % kSide) * step_y + static_cast<float>(i / kSide) * step_z;
    for (int x = 0; x < kSide; ++x, p += step_x) {
      if (p.z() < kNearM || p.z() >= frustum.farthest_m) continue;
      const float u = scan.fx * p.x() / p.z() + scan.cx, v = scan.fy * p.y() / p.z() + scan.cy;
      if (!(u >= 0 && v >= 0 && u < static_cast<float>(scan.columns) && v < static_cast<float>(scan.rows))) continue;
      const int pixel = static_cast<int>(v) * scan.columns + static_cast<int>(u);
      if (p.z() * kMmPerM >= static_cast<float>(scan.clear_mm[static_cast<std::size_t>(pixel)])) continue;
      if (counts == nullptr) counts = counts_.at(block, static_cast<std::size_t>(config_.max_blocks));
      if (counts == nullptr) {
        full_ = true;
        return;
      }
      auto& cell = (*counts)[static_cast<std::size_t>(i * kSide + x)];
      cell = static_cast<std::uint16_t>(cell + change);
    }
  }
}

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
