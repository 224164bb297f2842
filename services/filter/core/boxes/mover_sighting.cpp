// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/mover_sighting.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/vision/samples.hpp"

namespace rtd::filter {
namespace {

constexpr std::size_t kMinCells = 40, kEnoughCells = 300;  // every n-th cell of a large surface is enough

Eigen::Vector3d point_world(const MoverFrame& frame, int cell) {
  const auto i = static_cast<std::size_t>(cell);
  return frame.pose.T_world_camera * (frame.rays[i] * frame.grid.depth_m[i]).cast<double>();
}

std::vector<std::vector<int>> by_cluster(const DepthClusters& clusters, const CellMask& moving) {
  std::vector<std::vector<int>> cells(clusters.cells.size());
  for (std::size_t cell = 0; cell < moving.size(); ++cell) {
    if (moving[cell] != 0 && clusters.label[cell] >= 0)
      cells[static_cast<std::size_t>(clusters.label[cell])].push_back(static_cast<int>(cell));
  }
  return cells;
}

Eigen::AlignedBox3d extent_of(const std::vector<int>& cells, const MoverFrame& frame) {
  std::array<std::vector<double>, 3> along;
  const std::size_t step = 1 + cells.size() / kEnoughCells;
  for (std::size_t i = 0; i < cells.size(); i += step) {
    const Eigen::Vector3d p = point_world(frame, cells[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) along[axis].push_back(p[static_cast<Eigen::Index>(axis)]);
  }
  Eigen::AlignedBox3d extent;
  for (int axis = 0; axis < 3; ++axis) {
    std::tie(extent.min()[axis], extent.max()[axis]) = vision::spread(along[static_cast<std::size_t>(axis)]);
  }
  return extent;
}

bool touches_border(const std::vector<int>& cells, const GridShape& shape) {
  constexpr int kBorderCells = 2;
  constexpr std::ptrdiff_t kFew = 4;
  return std::count_if(cells.begin(), cells.end(), [&](int cell) {
           const int column = cell % shape.columns, row = cell / shape.columns;
           return std::min({column, row, shape.columns - 1 - column, shape.rows - 1 - row}) < kBorderCells;
         }) > kFew;
}

/// First and last cell that [first_px, last_px] touches, within 0 .. count - 1; empty when it ends before it begins.
std::pair<int, int> cell_span(double first_px, double last_px, int count, int cell_px) {
  const auto cell = [&](double px) {
    return static_cast<int>(std::floor(std::clamp(px / cell_px, -1.0, count * 1.0)));
  };
  return {std::max(0, cell(first_px)), std::min(count - 1, cell(last_px))};
}

}  // namespace

std::vector<MoverSighting> sight_movers(const MoverFrame& frame, const DepthClusters& clusters,
                                        const CellMask& moving) {
  std::vector<MoverSighting> sightings;
  for (const std::vector<int>& cells : by_cluster(clusters, moving)) {
    if (cells.size() < kMinCells) continue;
    const Eigen::AlignedBox3d extent = extent_of(cells, frame);
    const std::optional<Box> box = project(extent, frame);
    if (box) sightings.push_back({extent, *box, touches_border(cells, frame.grid.shape)});
  }
  return sightings;
}

std::optional<Box> project(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame) {
  constexpr double kMinDepthM = 0.1;
  const auto& p = frame.camera.parameters();
  const Eigen::Isometry3d T_camera_world = frame.pose.T_world_camera.inverse();
  Eigen::AlignedBox2d image;
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(i);
    const Eigen::Vector3d p_camera = T_camera_world * box_world.corner(corner);
    if (p_camera.z() < kMinDepthM) return std::nullopt;
    image.extend(Eigen::Vector2d(p.fx * p_camera.x() / p_camera.z() + p.cx, p.fy * p_camera.y() / p_camera.z() + p.cy));
  }
  return Box{image.center(), image.sizes()};
}

BoxContent look_into(const Eigen::AlignedBox3d& box_world, const MoverFrame& frame) {
  BoxContent content;
  const std::optional<Box> box = project(box_world, frame);
  if (!box) return content;
  const GridShape& shape = frame.grid.shape;
  const Eigen::Vector2d first = box->centre_px - 0.5 * box->size_px, last = box->centre_px + 0.5 * box->size_px;
  const auto [first_column, last_column] = cell_span(first.x(), last.x(), shape.columns, shape.cell_px);
  const auto [first_row, last_row] = cell_span(first.y(), last.y(), shape.rows, shape.cell_px);
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const int cell = shape.index(column, row);
      if (frame.grid.depth_m[static_cast<std::size_t>(cell)] <= 0) continue;
      ++content.measured;
      if (box_world.contains(point_world(frame, cell))) content.cells.push_back(cell);
    }
  }
  return content;
}

}  // namespace rtd::filter
