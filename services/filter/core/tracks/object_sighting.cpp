// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/tracks/object_sighting.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rtd::filter {
namespace {

constexpr std::size_t kEnoughPoints = 300, kEnoughMoving = 600;  // every n-th cell of a large surface
constexpr double kSeenLatelyS = 0.2;  // movers without a class: longer out of sight is only expected
constexpr double kMoves = 0.5;        // static probability below which an object of a lower level counts

std::vector<SeenPoint> points_of(const std::vector<int>& cells, const SeenCells& seen, std::size_t enough) {
  std::vector<SeenPoint> points;
  const std::size_t step = 1 + cells.size() / enough;
  for (std::size_t i = 0; i < cells.size(); i += step) {
    const auto cell = static_cast<std::size_t>(cells[i]);
    const float depth_m = seen.grid.depth_m[cell];
    if (depth_m > 0) points.push_back({(seen.rays[cell] * depth_m).cast<double>(), tint_of(seen.color_bgr(cell))});
  }
  return points;
}

/// Of the features on an object; of its cells when it has none.
double static_probability_of(std::size_t index, const SceneObject& object, const Verdict& verdict) {
  double sum = 0;
  int count = 0;
  for (const msg::Feature& feature : verdict.features) {
    if (feature.object_id != static_cast<std::int16_t>(index)) continue;
    sum += static_cast<double>(feature.static_probability);
    ++count;
  }
  if (count > 0) return sum / count;
  if (object.cells.empty() || verdict.motion.empty()) return 1;
  const auto dynamic = std::ranges::count_if(
      object.cells, [&](int cell) { return verdict.motion[static_cast<std::size_t>(cell)] == CellMotion::kDynamic; });
  return 1 - static_cast<double>(dynamic) / static_cast<double>(object.cells.size());
}

/// Cells of which the depth lies within a box in space.
std::vector<int> cells_in(const Eigen::AlignedBox3d& box_world, const Eigen::Isometry3d& T_world_camera,
                          const SeenCells& seen) {
  const std::vector<float>& depth_m = seen.grid.depth_m;
  std::vector<int> cells;
  for (std::size_t cell = 0; cell < depth_m.size(); ++cell) {
    if (depth_m[cell] <= 0) continue;
    const Eigen::Vector3d p_camera = (seen.rays[cell] * depth_m[cell]).cast<double>();
    if (box_world.contains(T_world_camera * p_camera)) cells.push_back(static_cast<int>(cell));
  }
  return cells;
}

/// Cells in a box that move, or belong to something that may.
std::vector<int> moving_cells_of(const CellBox& box, const GridShape& shape, const std::vector<CellMotion>& motion) {
  std::vector<int> cells;
  if (motion.empty()) return cells;
  for (int row = box.top; row < box.bottom; ++row) {
    for (int column = box.left; column < box.right; ++column) {
      const int cell = shape.index(column, row);
      if (motion[static_cast<std::size_t>(cell)] == CellMotion::kDynamic) cells.push_back(cell);
    }
  }
  return cells;
}

/// Whether more than a quarter of the rows of some ascending cells end, in this direction (-1 left, 1 right), at the
/// border of the image or at something nearer.
bool is_cut(const std::vector<int>& cells, int direction, const DepthGrid& grid) {
  constexpr double kNearerM = 0.12, kShare = 0.25;
  constexpr int kBeside = 2;  // cells: the next one may mix both depths
  const int columns = grid.shape.columns;
  int rows = 0, cut = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t next = direction < 0 ? i - 1 : i + 1;  // of none: the largest number
    if (next < cells.size() && cells[next] / columns == cells[i] / columns) continue;
    ++rows;
    const int column = cells[i] % columns + kBeside * direction;
    if (column < 0 || column >= columns) {
      ++cut;
      continue;
    }
    const float beside_m = grid.depth_m[static_cast<std::size_t>(cells[i] + kBeside * direction)];
    const float here_m = grid.depth_m[static_cast<std::size_t>(cells[i])];
    if (beside_m > 0 && here_m > 0 && static_cast<double>(here_m - beside_m) > kNearerM) ++cut;
  }
  return cut > kShare * rows;
}

}  // namespace

std::vector<ObjectSighting> sight_objects(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                          const SeenCells& seen) {
  constexpr double kMarginM = 0.05;
  std::vector<ObjectSighting> sightings;
  const auto add = [&](ObjectSighting sighting, const std::vector<int>& cells, const std::vector<int>& moving) {
    sighting.points = points_of(cells, seen, kEnoughPoints);
    if (sighting.points.empty()) return;
    sighting.moving = points_of(moving, seen, kEnoughMoving);
    sighting.cut_left = is_cut(cells, -1, seen.grid);
    sighting.cut_right = is_cut(cells, 1, seen.grid);
    sightings.push_back(std::move(sighting));
  };
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const SceneObject& object = objects[i];
    if (object.flat || object.track_id < 0) continue;
    const double probability = static_probability_of(i, object, verdict);
    if (object.level != MotionLevel::kHigh && probability >= kMoves) continue;
    add({.source = 2 * static_cast<std::uint32_t>(object.track_id),
         .class_name = object.class_name,
         .score = static_cast<double>(object.score),
         .static_probability = probability},
        object.cells, moving_cells_of(object.box, seen.grid.shape, verdict.motion));
  }
  for (const Mover& mover : verdict.movers) {
    if (mover.unseen_s > kSeenLatelyS) continue;
    Eigen::AlignedBox3d box = mover.extent_world;
    box.min().array() -= kMarginM;
    box.max().array() += kMarginM;
    const std::vector<int> cells = cells_in(box, verdict.T_world_camera, seen);
    add({.source = 2 * static_cast<std::uint32_t>(mover.id) + 1, .score = 1}, cells, cells);
  }
  return sightings;
}

}  // namespace rtd::filter
