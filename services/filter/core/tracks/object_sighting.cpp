// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What one frame shows of each object: sight_objects().
#include <algorithm>
#include <cmath>
#include <utility>

#include "services/filter/core/tracks/world_movers.hpp"

namespace rtd::filter {
namespace {

constexpr std::size_t kEnoughPoints = 300;  // every n-th cell of a large surface
constexpr double kSeenLatelyS = 0.2;        // movers without a class: longer out of sight is only expected
constexpr double kMoves = 0.5;              // static probability below which an object of a lower level counts

std::vector<Eigen::Vector3d> points_of(const std::vector<int>& cells, const DepthGrid& grid,
                                       const std::vector<Eigen::Vector3f>& rays) {
  std::vector<Eigen::Vector3d> points_m;
  const std::size_t step = 1 + cells.size() / kEnoughPoints;
  for (std::size_t i = 0; i < cells.size(); i += step) {
    const auto cell = static_cast<std::size_t>(cells[i]);
    if (grid.depth_m[cell] > 0) points_m.push_back((rays[cell] * grid.depth_m[cell]).cast<double>());
  }
  return points_m;
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
                          const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays) {
  std::vector<int> cells;
  for (std::size_t cell = 0; cell < grid.depth_m.size(); ++cell) {
    if (grid.depth_m[cell] <= 0) continue;
    const Eigen::Vector3d p_camera = (rays[cell] * grid.depth_m[cell]).cast<double>();
    if (box_world.contains(T_world_camera * p_camera)) cells.push_back(static_cast<int>(cell));
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

void see_surface(const std::vector<int>& cells, const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                 ObjectSighting& sighting) {
  sighting.points_m = points_of(cells, grid, rays);
  sighting.cut_left = is_cut(cells, -1, grid);
  sighting.cut_right = is_cut(cells, 1, grid);
}

}  // namespace

std::vector<ObjectSighting> sight_objects(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                          const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays) {
  constexpr double kMarginM = 0.05;
  std::vector<ObjectSighting> sightings;
  const auto add = [&](ObjectSighting sighting, const std::vector<int>& cells) {
    see_surface(cells, grid, rays, sighting);
    if (!sighting.points_m.empty()) sightings.push_back(std::move(sighting));
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
        object.cells);
  }
  for (const Mover& mover : verdict.movers) {
    if (mover.unseen_s > kSeenLatelyS) continue;
    Eigen::AlignedBox3d box = mover.extent_world;
    box.min().array() -= kMarginM;
    box.max().array() += kMarginM;
    add({.source = 2 * static_cast<std::uint32_t>(mover.id) + 1, .score = 1},
        cells_in(box, verdict.T_world_camera, grid, rays));
  }
  return sightings;
}

}  // namespace rtd::filter
