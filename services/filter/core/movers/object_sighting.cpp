// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/movers/object_sighting.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/vision/samples.hpp"

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

/// A surface without a depth step in it, of cells that move or belong to something that may.
struct MovingSurface {
  std::vector<int> cells;  ///< ascending
  CellBox box;
  double depth_m = 0;  ///< median
};

double area(const CellBox& box) {
  return static_cast<double>(std::max(0, box.right - box.left)) * std::max(0, box.bottom - box.top);
}

CellBox join(const CellBox& a, const CellBox& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right), std::max(a.bottom, b.bottom)};
}

/// Intersection over union.
double overlap(const CellBox& a, const CellBox& b) {
  const double both = area(
      {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right), std::min(a.bottom, b.bottom)});
  return both / std::max(1.0, area(a) + area(b) - both);
}

/// Whether a cell lies in the mask without the rim by which it was grown.
bool moves(int cell, const std::vector<CellMotion>& motion, const GridShape& shape) {
  const int column = cell % shape.columns, row = cell / shape.columns;
  for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    const int x = std::clamp(column + dx, 0, shape.columns - 1), y = std::clamp(row + dy, 0, shape.rows - 1);
    if (motion[static_cast<std::size_t>(shape.index(x, y))] != CellMotion::kDynamic) return false;
  }
  return true;
}

std::vector<MovingSurface> find_moving_surfaces(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                                const DepthGrid& seen) {
  const GridShape& shape = seen.shape;
  DepthGrid grid{shape, std::vector<float>(seen.depth_m.size(), 0.0F), {}, {}};
  const auto keep = [&](int cell) {
    grid.depth_m[static_cast<std::size_t>(cell)] = seen.depth_m[static_cast<std::size_t>(cell)];
  };
  for (int cell = 0; cell < static_cast<int>(verdict.motion.size()); ++cell) {
    if (moves(cell, verdict.motion, shape)) keep(cell);
  }
  for (const SceneObject& object : objects) {
    if (!object.flat) std::ranges::for_each(object.cells, keep);
  }
  const DepthClusters clusters = find_depth_clusters(grid, {});
  std::vector<MovingSurface> surfaces(static_cast<std::size_t>(clusters.count()));
  std::vector<std::vector<float>> depths_m(surfaces.size());
  for (int cell = 0; cell < shape.size(); ++cell) {
    const std::int32_t label = clusters.label[static_cast<std::size_t>(cell)];
    if (label < 0) continue;
    MovingSurface& surface = surfaces[static_cast<std::size_t>(label)];
    const int column = cell % shape.columns, row = cell / shape.columns;
    const CellBox of_cell{column, row, column + 1, row + 1};
    surface.box = surface.cells.empty() ? of_cell : join(surface.box, of_cell);
    surface.cells.push_back(cell);
    depths_m[static_cast<std::size_t>(label)].push_back(grid.depth_m[static_cast<std::size_t>(cell)]);
  }
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    surfaces[i].depth_m = static_cast<double>(vision::median(std::move(depths_m[i])));
  return surfaces;
}

using SurfacesInBox = std::vector<const MovingSurface*>;

/// Surfaces at about one depth that together fill a box.
struct Body {
  SurfacesInBox surfaces;
  CellBox bounds;
  double fit = 0;  ///< overlap of the bounds with the box
};

/// Those that lie mostly in a box, the largest first.
SurfacesInBox surfaces_in(const CellBox& box, const std::vector<MovingSurface>& surfaces, const GridShape& shape) {
  SurfacesInBox inside;
  for (const MovingSurface& surface : surfaces) {
    const auto count = static_cast<std::size_t>(std::ranges::count_if(
        surface.cells, [&](int cell) { return box.contains(cell % shape.columns, cell / shape.columns); }));
    if (2 * count >= surface.cells.size()) inside.push_back(&surface);
  }
  std::ranges::stable_sort(inside, std::greater{}, [](const MovingSurface* surface) { return surface->cells.size(); });
  return inside;
}

Body best_body(const CellBox& box, const SurfacesInBox& inside) {
  constexpr double kThickM = 0.35;
  Body best;
  for (const MovingSurface* first : inside) {
    Body body{{first}, first->box, overlap(first->box, box)};
    for (const MovingSurface* more : inside) {
      const CellBox larger = join(body.bounds, more->box);
      const double fit = overlap(larger, box);
      if (more == first || fit < body.fit || std::abs(more->depth_m - first->depth_m) > kThickM) continue;
      body.surfaces.push_back(more);
      body.bounds = larger;
      body.fit = fit;
    }
    if (body.fit > best.fit) best = std::move(body);
  }
  return best;
}

/// Gives each surface to the object whose box it fills best. Of two boxes that overlap, both masks show the nearer
/// body; here the farther one is found by its own size. Where nothing fits, the mask is left as it is.
std::vector<std::vector<int>> assign_surfaces(const std::vector<MovingSurface>& surfaces,
                                              const std::vector<SceneObject>& objects, const GridShape& shape) {
  constexpr double kMinFit = 0.3;
  std::vector<std::vector<int>> cells_of;
  std::vector<SurfacesInBox> inside;  // per object; without those that are given away
  for (const SceneObject& object : objects) {
    cells_of.push_back(object.cells);
    inside.push_back(object.flat ? SurfacesInBox{} : surfaces_in(object.box, surfaces, shape));
  }
  for (;;) {
    Body best;
    std::size_t of = 0;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      Body body = best_body(objects[i].box, inside[i]);
      if (body.fit <= best.fit) continue;
      best = std::move(body);
      of = i;
    }
    if (best.fit < kMinFit) return cells_of;
    cells_of[of].clear();
    inside[of].clear();
    for (const MovingSurface* surface : best.surfaces) {
      cells_of[of].insert(cells_of[of].end(), surface->cells.begin(), surface->cells.end());
      for (SurfacesInBox& others : inside) std::erase(others, surface);
    }
    std::ranges::sort(cells_of[of]);
  }
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

std::uint8_t tint_of(const cv::Vec3b& bgr) {
  constexpr int kHues = 8, kPartDeg = 360 / kHues;  // red lies in the middle of a part
  constexpr int kGrey = 40, kStrong = 110, kBlack = 30, kDark = 60, kBright = 140;
  const int blue = bgr[0], green = bgr[1], red = bgr[2];
  const int value = std::max({blue, green, red}), range = value - std::min({blue, green, red});
  const int saturation = value > 0 ? 255 * range / value : 0;
  if (saturation < kGrey || value < kBlack)
    return static_cast<std::uint8_t>(2 * kHues + (value < kDark ? 0 : value < kBright ? 1 : 2));
  int hue_deg = 240 + 60 * (red - green) / range;
  if (value == red)
    hue_deg = 60 * (green - blue) / range;
  else if (value == green)
    hue_deg = 120 + 60 * (blue - red) / range;
  const int hue = (hue_deg + 360 + kPartDeg / 2) % 360 / kPartDeg;
  return static_cast<std::uint8_t>(2 * hue + (saturation >= kStrong ? 1 : 0));
}

double histogram_distance(const ColorHistogram& a, const ColorHistogram& b) {
  if (a.isZero() || b.isZero()) return 0;
  return 1 - a.cwiseProduct(b).cwiseSqrt().sum();
}

std::vector<ObjectSighting> sight_objects(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                          const SeenCells& seen) {
  constexpr double kMarginM = 0.05;
  constexpr std::size_t kFewPoints = 12, kFewCells = 80;
  const GridShape& shape = seen.grid.shape;
  std::vector<ObjectSighting> sightings;
  CellMask explained(seen.grid.depth_m.size(), 0);
  const auto add = [&](ObjectSighting sighting, const std::vector<int>& cells, const std::vector<int>& moving) {
    for (const int cell : cells) explained[static_cast<std::size_t>(cell)] = 1;
    sighting.points = points_of(cells, seen, kEnoughPoints);
    if (sighting.points.size() < kFewPoints) return;
    sighting.moving = points_of(moving, seen, kEnoughMoving);
    sighting.cut_left = is_cut(cells, -1, seen.grid);
    sighting.cut_right = is_cut(cells, 1, seen.grid);
    sightings.push_back(std::move(sighting));
  };
  const auto erase_explained = [&](std::vector<int> cells) {
    std::erase_if(cells, [&](int cell) { return explained[static_cast<std::size_t>(cell)] != 0; });
    return cells;
  };
  const std::vector<MovingSurface> surfaces = find_moving_surfaces(objects, verdict, seen.grid);
  const std::vector<std::vector<int>> cells_of = assign_surfaces(surfaces, objects, shape);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const SceneObject& object = objects[i];
    if (object.flat || object.track_id < 0) continue;
    const double probability = static_probability_of(i, object, verdict);
    if (object.level != MotionLevel::kHigh && probability >= kMoves) continue;
    add({.source = 2 * static_cast<std::uint32_t>(object.track_id),
         .class_name = object.class_name,
         .score = static_cast<double>(object.score),
         .static_probability = probability},
        cells_of[i], moving_cells_of(object.box, shape, verdict.motion));
  }
  for (const TrackedMover& mover : verdict.movers) {
    if (mover.unseen_s > kSeenLatelyS) continue;
    Eigen::AlignedBox3d box = mover.extent_world;
    box.min().array() -= kMarginM;
    box.max().array() += kMarginM;
    const std::vector<int> cells = erase_explained(cells_in(box, verdict.T_world_camera, seen));
    add({.source = 2 * static_cast<std::uint32_t>(mover.id) + 1, .score = 1}, cells, cells);
  }
  for (const MovingSurface& surface : surfaces) {
    const std::vector<int> cells = erase_explained(surface.cells);
    if (cells.size() >= std::max(kFewCells, surface.cells.size() / 2)) add({.score = 1}, cells, cells);
  }
  return sightings;
}

}  // namespace rtd::filter
