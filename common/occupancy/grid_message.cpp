// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/occupancy/grid_message.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/msg/stamps.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::occupancy {
namespace {

constexpr std::size_t kMaxCells = 16'000'000;
constexpr double kFarthest_m = 10'000;

/// A floor plan whose place is plausible. `corner`: of its first cell, x along columns, y along rows.
struct Sheet {
  const msg::OccupancyGrid* plan;
  double cell_m;
  Eigen::Isometry3d T_map_corner;

  Eigen::Vector2d size_m() const { return cell_m * Eigen::Vector2d(plan->info.width, plan->info.height); }
  /// In the middle of the sheet's plane.
  std::int8_t at(const Eigen::Vector2d& p_corner) const {
    const Eigen::Vector2d cell = p_corner / cell_m;
    if (cell.minCoeff() < 0 || !(cell.x() < plan->info.width) || !(cell.y() < plan->info.height))
      return NavigationGrid::kUnknown;
    return plan->data[static_cast<std::size_t>(cell.y()) * plan->info.width + static_cast<std::size_t>(cell.x())];
  }
};

std::vector<Sheet> to_sheets(std::span<const PlacedPlan> plans) {
  constexpr double kFinest_m = 0.005, kCoarsest_m = 10;
  std::vector<Sheet> sheets;
  for (const auto& [T_map_robot, plan] : plans) {
    const auto& [at, q] = plan->info.origin;
    const msg::Transform origin{{at.x, at.y, at.z}, {q.x, q.y, q.z, q.w}};
    const auto cell_m = static_cast<double>(plan->info.resolution);
    if (plan->data.empty() || !msg::is_rotation(origin.rotation_xyzw) ||
        !(cell_m >= kFinest_m && cell_m <= kCoarsest_m))
      continue;
    const Sheet sheet{plan, cell_m, T_map_robot * msg::to_isometry(origin)};
    if (sheet.T_map_corner.translation().norm() < kFarthest_m && sheet.size_m().norm() < kFarthest_m)
      sheets.push_back(sheet);
  }
  return sheets;
}

Eigen::Matrix3d upright(const std::vector<Sheet>& sheets) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const Sheet& sheet : sheets) up += sheet.T_map_corner.linear().col(2);
  return grid_rotation(up.norm() > 0.1 ? up : Eigen::Vector3d(sheets.front().T_map_corner.linear().col(2)));
}

/// The cells whose middle a sheet may cover.
Eigen::AlignedBox2i cells_of(const Sheet& sheet, const Eigen::Matrix3d& R_grid_map, double cell_m) {
  const double edge_m = 1e-3 * cell_m;  // no middle is nearer to a border
  Eigen::AlignedBox2i box;
  for (const double x : {edge_m, sheet.size_m().x() - edge_m}) {
    for (const double y : {edge_m, sheet.size_m().y() - edge_m}) {
      const Eigen::Vector3d p_grid = R_grid_map * (sheet.T_map_corner * Eigen::Vector3d(x, y, 0));
      box.extend((p_grid.head<2>() / cell_m).array().floor().cast<int>().matrix());
    }
  }
  return box;
}

/// Each cell takes what the sheet has in its middle: a turned sheet leaves no gaps.
void draw(const Sheet& sheet, const Eigen::Matrix3d& R_grid_map, NavigationGrid& grid) {
  const Eigen::AlignedBox2i box = cells_of(sheet, R_grid_map, grid.cell_m).intersection(grid.extent());
  const double level_m = (R_grid_map * sheet.T_map_corner.translation()).z();
  const Eigen::Isometry3d T_corner_grid = sheet.T_map_corner.inverse() * Eigen::Isometry3d(R_grid_map.transpose());
  for (int y = box.min().y(); y <= box.max().y(); ++y) {
    for (int x = box.min().x(); x <= box.max().x(); ++x) {
      const Eigen::Vector3d middle(grid.cell_m * (x + 0.5), grid.cell_m * (y + 0.5), level_m);
      grid.mark({x, y}, sheet.at((T_corner_grid * middle).head<2>()));
    }
  }
}

}  // namespace

msg::OccupancyGrid make_grid(const NavigationGrid& grid, const Eigen::Matrix3d& R_grid_map, std::int64_t stamp_ns,
                             const std::string& map_frame) {
  msg::OccupancyGrid message;
  message.header = {msg::to_time(stamp_ns), map_frame};
  message.info.map_load_time = message.header.stamp;
  message.info.resolution = static_cast<float>(grid.cell_m);
  message.info.width = static_cast<std::uint32_t>(grid.columns);
  message.info.height = static_cast<std::uint32_t>(grid.rows);
  const Eigen::Vector3d corner =
      R_grid_map.transpose() * Eigen::Vector3d(grid.origin_m().x(), grid.origin_m().y(), grid.floor_m);
  const Eigen::Quaterniond q(Eigen::Matrix3d(R_grid_map.transpose()));
  message.info.origin = {{corner.x(), corner.y(), corner.z()}, {q.x(), q.y(), q.z(), q.w()}};
  message.data = grid.cells;
  return message;
}

msg::OccupancyGrid join_plans(std::span<const PlacedPlan> plans, std::int64_t stamp_ns, const std::string& map_frame) {
  const std::vector<Sheet> sheets = to_sheets(plans);
  if (sheets.empty()) return make_grid({}, Eigen::Matrix3d::Identity(), stamp_ns, map_frame);
  const Eigen::Matrix3d R_grid_map = upright(sheets);
  const double cell_m = std::ranges::min(sheets, {}, &Sheet::cell_m).cell_m;
  Eigen::AlignedBox2i box;
  double floor_m = 0;
  for (const Sheet& sheet : sheets) {
    box.extend(cells_of(sheet, R_grid_map, cell_m));
    floor_m += (R_grid_map * sheet.T_map_corner.translation()).z() / static_cast<double>(sheets.size());
  }
  NavigationGrid grid = NavigationGrid::unknown(box, cell_m, kMaxCells);
  grid.floor_m = floor_m;
  for (const Sheet& sheet : sheets) draw(sheet, R_grid_map, grid);
  return make_grid(grid, R_grid_map, stamp_ns, map_frame);
}

}  // namespace rtd::occupancy
