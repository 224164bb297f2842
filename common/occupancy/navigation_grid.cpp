// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/occupancy/navigation_grid.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>
#include <stdexcept>

namespace rtd::occupancy {
namespace {

/// What counts for the floor plan in a column of cells.
enum class Column { kNothing, kClear, kObstacle };

Column judge(const Volume& volume, int z, Space space, double floor_m, const RobotHeights& heights) {
  const double height_m = (z + 0.5) * volume.cell_m - floor_m;
  if (space == Space::kOccupied)
    return height_m > heights.min_height_m && height_m < heights.max_height_m ? Column::kObstacle : Column::kNothing;
  return height_m > 0 && height_m < heights.clear_below_m ? Column::kClear : Column::kNothing;
}

/// True when the box has more than `max_cells`, and now no more.
bool crop(Eigen::AlignedBox2i& box, std::size_t max_cells) {
  const auto side = [&](int axis) { return std::int64_t{box.max()[axis]} - box.min()[axis] + 1; };
  const auto most = static_cast<std::int64_t>(max_cells);
  if (side(0) * side(1) <= most) return false;
  const auto half = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::sqrt(static_cast<double>(most))) / 2);
  for (int axis = 0; axis < 2; ++axis) {  // a long corridor keeps its length
    const std::int64_t allowed = std::max(2 * half, most / side(1 - axis));
    if (side(axis) <= allowed) continue;
    const int middle = box.min()[axis] + static_cast<int>(side(axis) / 2);
    box.min()[axis] = middle - static_cast<int>(allowed / 2);
    box.max()[axis] = box.min()[axis] + static_cast<int>(allowed) - 1;
  }
  return true;
}

}  // namespace

NavigationGrid NavigationGrid::unknown(Eigen::AlignedBox2i box, double cell_m, std::size_t max_cells) {
  NavigationGrid grid;
  grid.cell_m = cell_m;
  if (box.isEmpty()) return grid;
  grid.cropped = crop(box, max_cells);
  grid.first = box.min();
  grid.columns = box.max().x() - box.min().x() + 1;
  grid.rows = box.max().y() - box.min().y() + 1;
  grid.cells.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), kUnknown);
  return grid;
}

void NavigationGrid::mark(const Eigen::Vector2i& cell, std::int8_t value) {
  const Eigen::Vector2i at = cell - first;
  auto& known =
      cells[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(at.x())];
  known = std::max(known, value);
}

std::int8_t NavigationGrid::at(const Eigen::Vector2i& cell) const {
  const Eigen::Vector2i at = cell - first;
  if (at.x() < 0 || at.y() < 0 || at.x() >= columns || at.y() >= rows) return kUnknown;
  return cells[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(at.x())];
}

Eigen::Matrix3d grid_rotation(const Eigen::Vector3d& up) {
  if (!up.allFinite() || up.norm() < 1e-3) throw std::invalid_argument("the direction of up has no length");
  const Eigen::Vector3d z = up.normalized();
  const Eigen::Vector3d level = Eigen::Vector3d::UnitX() - z.x() * z;
  const Eigen::Vector3d x = level.norm() > 0.1 ? Eigen::Vector3d(level.normalized()) : z.unitOrthogonal();
  Eigen::Matrix3d R;
  R.row(0) = x;
  R.row(1) = z.cross(x);
  R.row(2) = z;
  return R;
}

void FloorFinder::add(double z_m) {
  const double bin = (z_m + kFarthestM) / kBinM;
  if (bin >= 0 && bin < static_cast<double>(bins_.size())) ++bins_[static_cast<std::size_t>(bin)];
}

std::optional<double> FloorFinder::floor_m(double below_m) const {
  constexpr std::size_t kWindow = 6;    // bins: a floor is so thick
  constexpr double kShareOfMost = 0.3;  // of the points of the fullest level
  const double limit = std::clamp((below_m + kFarthestM) / kBinM, 0.0, static_cast<double>(bins_.size()));
  const auto end = static_cast<std::size_t>(limit);
  std::vector<std::uint64_t> levels;  // points from a bin on
  for (std::size_t i = 0; i + kWindow <= end; ++i) {
    std::uint64_t sum = 0;
    for (std::size_t k = i; k < i + kWindow; ++k) sum += bins_[k];
    levels.push_back(sum);
  }
  const auto fullest = std::ranges::max_element(levels);
  if (fullest == levels.end() || *fullest == 0) return std::nullopt;
  const auto many = static_cast<std::uint64_t>(kShareOfMost * static_cast<double>(*fullest));
  auto level = std::ranges::find_if(levels, [many](std::uint64_t points) { return points > many; });
  level = std::max_element(level, std::min(levels.end(), level + kWindow));
  double sum = 0;
  for (std::size_t k = 0; k < kWindow; ++k) {
    const auto bin = static_cast<std::size_t>(level - levels.begin()) + k;
    sum += bins_[bin] * ((static_cast<double>(bin) + 0.5) * kBinM - kFarthestM);
  }
  return sum / static_cast<double>(*level);
}

NavigationGrid project(const Volume& volume, double floor_m, const RobotHeights& heights, std::size_t max_cells) {
  const auto judge_cell = [&](const Eigen::Vector3i& cell, Space space) {
    return judge(volume, cell.z(), space, floor_m, heights);
  };
  Eigen::AlignedBox2i box;  // with a column that counts
  volume.cells.for_each([&](const Eigen::Vector3i& cell, Space space) {
    if (judge_cell(cell, space) != Column::kNothing) box.extend(cell.head<2>());
  });
  NavigationGrid grid = NavigationGrid::unknown(box, volume.cell_m, max_cells);
  grid.floor_m = floor_m;
  if (box.isEmpty()) return grid;
  const Eigen::AlignedBox2i kept = grid.extent();
  volume.cells.for_each([&](const Eigen::Vector3i& cell, Space space) {
    const Column column = judge_cell(cell, space);
    if (column == Column::kNothing || !kept.contains(Eigen::Vector2i(cell.head<2>()))) return;
    grid.mark(cell.head<2>(), column == Column::kObstacle ? NavigationGrid::kOccupied : NavigationGrid::kFree);
  });
  return grid;
}

void write_pgm(std::ostream& out, const NavigationGrid& grid) {
  out << "P5\n# RTD-SLAM floor plan, " << grid.cell_m << " m/pixel\n" << grid.columns << ' ' << grid.rows << "\n255\n";
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::int8_t cell = grid.at(grid.first + Eigen::Vector2i(column, row));
      out.put(static_cast<char>(cell == NavigationGrid::kOccupied ? 0 : cell == NavigationGrid::kFree ? 254 : 205));
    }
  }
}

std::string map_yaml(const NavigationGrid& grid, const std::string& image) {
  std::ostringstream text;  // 205 means unknown: it lies between the thresholds
  text << "image: " << image << "\nmode: trinary\nresolution: " << grid.cell_m << "\norigin: [" << grid.origin_m().x()
       << ", " << grid.origin_m().y() << ", 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return text.str();
}

}  // namespace rtd::occupancy
