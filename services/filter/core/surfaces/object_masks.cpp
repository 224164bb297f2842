// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/object_masks.hpp"
#include "common/vision/samples.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "services/filter/core/surfaces/foreground.hpp"

namespace rtd::filter {
namespace {

/// The object is the nearest cluster with this share of the measured cells of its box.
constexpr double kMinShare = 0.15;
constexpr double kMinContained = 0.5;  ///< with this share inside the box, the whole cluster is the object

constexpr float kAbsurdPx = 1e5F;

bool is_box(const vision::Detection& box) {
  for (const float value : {box.x_px, box.y_px, box.width_px, box.height_px}) {
    if (!std::isfinite(value) || std::abs(value) > kAbsurdPx) return false;
  }
  return box.width_px > 0 && box.height_px > 0;
}

std::optional<CellBox> to_cells(const vision::Detection& box, const geometry::CameraModel& camera,
                                const GridShape& shape) {
  if (!is_box(box)) return std::nullopt;
  const auto& p = camera.parameters();
  const Eigen::Vector2d size(p.width - 1, p.height - 1);
  const Eigen::Vector2d first = Eigen::Vector2d(box.x_px, box.y_px).cwiseMax(0.0).cwiseMin(size);
  const Eigen::Vector2d last =
      Eigen::Vector2d(box.x_px + box.width_px, box.y_px + box.height_px).cwiseMax(0.0).cwiseMin(size);
  if (last.x() - first.x() < shape.cell_px || last.y() - first.y() < shape.cell_px) return std::nullopt;
  const Eigen::Vector2d from = camera.undistort(first) / shape.cell_px, to = camera.undistort(last) / shape.cell_px;
  const CellBox cells{std::max(0, static_cast<int>(std::floor(from.x()))),
                      std::max(0, static_cast<int>(std::floor(from.y()))),
                      std::min(shape.columns, static_cast<int>(std::ceil(to.x())) + 1),
                      std::min(shape.rows, static_cast<int>(std::ceil(to.y())) + 1)};
  if (cells.left >= cells.right || cells.top >= cells.bottom) return std::nullopt;
  return cells;
}

struct SurfacesInView {
  const DepthGrid& grid;
  const DepthClusters& clusters;
};

/// A depth cluster as far as it lies inside a box.
struct ClusterInBox {
  std::int32_t label;
  std::vector<int> cells;
  float median_m;
};

std::vector<ClusterInBox> clusters_in(const CellBox& box, const DepthGrid& grid, const DepthClusters& clusters) {
  std::vector<std::vector<int>> cells_of(static_cast<std::size_t>(clusters.count()));
  for (int row = box.top; row < box.bottom; ++row) {
    for (int column = box.left; column < box.right; ++column) {
      const int cell = grid.shape.index(column, row);
      const std::int32_t label = clusters.label[static_cast<std::size_t>(cell)];
      if (label >= 0) cells_of[static_cast<std::size_t>(label)].push_back(cell);
    }
  }
  std::vector<ClusterInBox> found;
  for (std::size_t label = 0; label < cells_of.size(); ++label) {
    std::vector<int>& cells = cells_of[label];
    if (cells.empty()) continue;
    std::vector<float> depths;
    depths.reserve(cells.size());
    for (const int cell : cells) depths.push_back(grid.depth_m[static_cast<std::size_t>(cell)]);
    found.push_back({static_cast<std::int32_t>(label), std::move(cells), vision::median(std::move(depths))});
  }
  return found;
}

/// The nearest cluster that fills enough of the box; none when nothing was measured.
const ClusterInBox* object_cluster(const std::vector<ClusterInBox>& inside, double min_share) {
  std::size_t measured = 0;
  for (const ClusterInBox& cluster : inside) measured += cluster.cells.size();
  const ClusterInBox* nearest = nullptr;
  for (const ClusterInBox& cluster : inside) {
    if (static_cast<double>(cluster.cells.size()) < min_share * static_cast<double>(measured)) continue;
    if (nearest == nullptr || cluster.median_m < nearest->median_m) nearest = &cluster;
  }
  return nearest;
}

/// The largest cluster near the depth that is expected of the object; none when it is hidden.
const ClusterInBox* cluster_at_depth(const std::vector<ClusterInBox>& inside, double depth_m, double tolerance_m) {
  const ClusterInBox* largest = nullptr;
  for (const ClusterInBox& cluster : inside) {
    if (std::abs(static_cast<double>(cluster.median_m) - depth_m) > tolerance_m) continue;
    if (largest == nullptr || cluster.cells.size() > largest->cells.size()) largest = &cluster;
  }
  return largest;
}

/// How much of a cluster belongs to an object.
enum class Share : std::uint8_t { kNothing, kNearItsDepth, kAll };

/// Per cluster: all of it when it lies mostly in the box; of one that has grown together with the background only what
/// is near the object's depth.
std::vector<Share> shares_of(const ClusterInBox& object, const std::vector<ClusterInBox>& inside,
                             const DepthClusters& clusters, const MaskConfig& config) {
  std::vector<Share> shares(clusters.cells.size(), Share::kNothing);
  for (const ClusterInBox& cluster : inside) {
    const auto label = static_cast<std::size_t>(cluster.label);
    const bool contained = static_cast<double>(cluster.cells.size()) / clusters.cells[label] >= kMinContained;
    const bool cut_off = contained && std::abs(cluster.median_m - object.median_m) <= config.max_object_depth_m;
    if (cluster.label != object.label && !cut_off) continue;
    shares[label] = contained ? Share::kAll : Share::kNearItsDepth;
  }
  return shares;
}

/// The object's own cluster and the parts of it that a depth step cut off, in ascending order.
std::vector<int> collect_cells(const ClusterInBox& object, const CellBox& box, const std::vector<Share>& shares,
                               const DepthGrid& grid, const DepthClusters& clusters, const MaskConfig& config) {
  const auto near_object = [&](int cell) {
    return box.contains(cell % grid.shape.columns, cell / grid.shape.columns) &&
           std::abs(grid.depth_m[static_cast<std::size_t>(cell)] - object.median_m) <= config.max_object_depth_m;
  };
  std::vector<int> cells;
  for (int cell = 0; cell < grid.shape.size(); ++cell) {
    const std::int32_t label = clusters.label[static_cast<std::size_t>(cell)];
    const Share share = label < 0 ? Share::kNothing : shares[static_cast<std::size_t>(label)];
    if (share == Share::kAll || (share == Share::kNearItsDepth && near_object(cell))) cells.push_back(cell);
  }
  return cells;
}

/// Cells without depth inside the box that touch the object. Hair and dark clothes reflect little infrared light: what
/// is not measured there is the object rather than what lies behind it.
std::vector<int> holes_beside(const std::vector<int>& object, const CellBox& box, const DepthGrid& grid) {
  constexpr int kReachCells = 2;  // farther ones are as often a wall out of range
  const GridShape& shape = grid.shape;
  std::vector<char> reached(static_cast<std::size_t>(shape.size()), 0);
  std::vector<int> holes, front = object;
  for (const int cell : object) reached[static_cast<std::size_t>(cell)] = 1;
  for (int step = 0; step < kReachCells && !front.empty(); ++step) {
    std::vector<int> next;
    for (const int from : front) {
      const int column = from % shape.columns, row = from / shape.columns;
      for (const auto& [x, y] : {std::pair{column + 1, row}, {column - 1, row}, {column, row + 1}, {column, row - 1}}) {
        if (!box.contains(x, y)) continue;
        const int cell = shape.index(x, y);
        const auto at = static_cast<std::size_t>(cell);
        if (grid.depth_m[at] > 0 || std::exchange(reached[at], 1) != 0) continue;
        next.push_back(cell);
      }
    }
    holes.insert(holes.end(), next.begin(), next.end());
    front = std::move(next);
  }
  std::sort(holes.begin(), holes.end());
  return holes;
}

/// Everything in the box: all that can be said where nothing was measured.
std::vector<int> all_cells(const CellBox& box, const GridShape& shape) {
  std::vector<int> cells;
  for (int row = box.top; row < box.bottom; ++row) {
    for (int column = box.left; column < box.right; ++column) cells.push_back(shape.index(column, row));
  }
  return cells;
}

/// What the pixels of an object say about the cells in and near its box.
struct PixelCells {
  CellBox reach;  ///< the box, grown as for the network that found them: elsewhere they say nothing
  CellMask on;    ///< the object
  CellMask near;  ///< the object or a cell next to it: colour and depth are not registered any better
};

/// Empty where none of the object's cells can be seen.
std::optional<PixelCells> pixel_cells(const ObjectBox& from, const geometry::CameraModel& camera,
                                      const GridShape& shape) {
  constexpr float kReach = 0.1F;
  constexpr int kNearCells = 1;
  vision::Detection grown = from.detection;
  grown.x_px -= kReach * grown.width_px;
  grown.y_px -= kReach * grown.height_px;
  grown.width_px *= 1 + 2 * kReach;
  grown.height_px *= 1 + 2 * kReach;
  const std::optional<CellBox> reach = to_cells(grown, camera, shape);
  if (!reach) return std::nullopt;
  PixelCells pixels{*reach, CellMask(static_cast<std::size_t>(shape.size()), 0), {}};
  bool any = false;
  for (const int cell : all_cells(*reach, shape)) {
    const Eigen::Vector2d corner_px(cell % shape.columns * shape.cell_px, cell / shape.columns * shape.cell_px);
    const Eigen::Vector2d centre_px = corner_px.array() + 0.5 * (shape.cell_px - 1);
    if (!from.mask.covers(camera.distort(centre_px), from.detection)) continue;
    pixels.on[static_cast<std::size_t>(cell)] = 1;
    any = true;
  }
  if (!any) return std::nullopt;
  pixels.near = dilate(shape, pixels.on, kNearCells);
  return pixels;
}

/// The cluster with most of the object's pixels, if any has some.
const ClusterInBox* cluster_on_pixels(const std::vector<ClusterInBox>& inside, const CellMask& on) {
  const ClusterInBox* best = nullptr;
  std::ptrdiff_t most = 0;
  for (const ClusterInBox& cluster : inside) {
    const auto count = std::count_if(cluster.cells.begin(), cluster.cells.end(),
                                     [&](int cell) { return on[static_cast<std::size_t>(cell)] != 0; });
    if (count <= most) continue;
    most = count;
    best = &cluster;
  }
  return best;
}

/// Which cluster an object is: of a carried one the cluster where it is expected, else the one under its pixels or, if
/// it has none, the nearest large one.
const ClusterInBox* choose_cluster(const ObjectBox& from, const std::vector<ClusterInBox>& inside,
                                   const std::optional<PixelCells>& pixels, const MaskConfig& config) {
  if (from.carried && from.depth_m > 0) return cluster_at_depth(inside, from.depth_m, config.max_object_depth_m);
  const ClusterInBox* under = pixels ? cluster_on_pixels(inside, pixels->on) : nullptr;
  return under != nullptr ? under : object_cluster(inside, kMinShare);
}

/// The holes next to an object with those in its pixels, ascending.
std::vector<int> with_holes_on(const PixelCells& pixels, const DepthGrid& grid, const std::vector<int>& beside) {
  std::vector<int> on, both;
  for (const int cell : all_cells(pixels.reach, grid.shape)) {
    const auto at = static_cast<std::size_t>(cell);
    if (pixels.on[at] != 0 && grid.depth_m[at] <= 0) on.push_back(cell);
  }
  std::set_union(beside.begin(), beside.end(), on.begin(), on.end(), std::back_inserter(both));
  return both;
}

/// Leaves what lies next to the object's pixels to its surroundings, but for its holes and the cells for which `stays`
/// says so: networks miss dark clothes and arms.
void cut_by_pixels(SceneObject& object, const PixelCells& pixels, const GridShape& shape, const auto& stays) {
  const auto is_near = [&](int cell) { return pixels.near[static_cast<std::size_t>(cell)] != 0; };
  std::erase_if(object.cells, [&](int cell) {
    return pixels.reach.contains(cell % shape.columns, cell / shape.columns) && !is_near(cell) && !stays(cell);
  });
  const auto holds = [](const std::vector<int>& cells, int cell) {
    return std::binary_search(cells.begin(), cells.end(), cell);
  };
  for (const int cell : all_cells(pixels.reach, shape)) {
    if (!is_near(cell) && !holds(object.cells, cell) && !holds(object.holes, cell)) object.around.push_back(cell);
  }
}

/// What the depth shows of an object, its cluster being known; with its pixels.
void cut_by_depth(SceneObject& object, const ClusterInBox& cluster, const std::vector<ClusterInBox>& inside,
                  const std::optional<PixelCells>& pixels, const SurfacesInView& view, const MaskConfig& config) {
  const auto& [grid, clusters] = view;
  const std::vector<Share> shares = shares_of(cluster, inside, clusters, config);
  object.cells = collect_cells(cluster, object.box, shares, grid, clusters, config);
  object.flat = outline_step_share(object.cells, grid, config.min_outline_step_m) < config.min_outline_share;
  if (object.flat) return;
  if (config.holes) object.holes = holes_beside(object.cells, object.box, grid);
  if (!pixels) return;
  if (config.holes) object.holes = with_holes_on(*pixels, grid, object.holes);
  cut_by_pixels(
      object, *pixels, grid.shape, [&](int cell) {  // depth knows a cluster that lies mostly in the box better
        return shares[static_cast<std::size_t>(clusters.label[static_cast<std::size_t>(cell)])] == Share::kAll;
      });
}

}  // namespace

std::vector<std::size_t> usable_indices(const std::vector<vision::Detection>& detections, const MotionLevels& levels) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    const vision::Detection& detection = detections[i];
    if (std::isfinite(detection.score) && is_box(detection) && levels.find(detection.class_name)) known.push_back(i);
  }
  std::stable_sort(known.begin(), known.end(),
                   [&](std::size_t a, std::size_t b) { return detections[a].score > detections[b].score; });
  if (known.size() > kMaxObjects) known.resize(kMaxObjects);
  return known;
}

std::vector<vision::Detection> usable_detections(const std::vector<vision::Detection>& detections,
                                                 const MotionLevels& levels) {
  std::vector<vision::Detection> usable;
  for (const std::size_t index : usable_indices(detections, levels)) usable.push_back(detections[index]);
  return usable;
}

double depth_in_box(const vision::Detection& box, const geometry::CameraModel& camera, const DepthGrid& grid) {
  constexpr float kMargin = 0.2F, kMiddle = 0.6F;  // of a side: at the edges of a box is mostly background
  const vision::Detection middle{box.class_name,
                                 box.score,
                                 box.x_px + kMargin * box.width_px,
                                 box.y_px + kMargin * box.height_px,
                                 kMiddle * box.width_px,
                                 kMiddle * box.height_px};
  const std::optional<CellBox> cells = to_cells(middle, camera, grid.shape);
  std::vector<float> depths;
  if (cells) {
    for (const int cell : all_cells(*cells, grid.shape)) {
      const float depth_m = grid.depth_m[static_cast<std::size_t>(cell)];
      if (depth_m > 0) depths.push_back(depth_m);
    }
  }
  if (depths.empty()) return 0;
  const auto quarter = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 4);
  std::nth_element(depths.begin(), quarter, depths.end());
  return static_cast<double>(*quarter);
}

std::vector<SceneObject> find_objects(const std::vector<ObjectBox>& boxes, const MotionLevels& levels,
                                      const geometry::CameraModel& camera, const DepthGrid& grid,
                                      const DepthClusters& clusters, const MaskConfig& config) {
  std::vector<SceneObject> objects;
  for (const ObjectBox& from : boxes) {
    const vision::Detection& detection = from.detection;
    const std::optional<MotionLevel> level = levels.find(detection.class_name);
    const std::optional<CellBox> box = level ? to_cells(detection, camera, grid.shape) : std::nullopt;
    if (!box) continue;
    SceneObject object{detection.class_name, detection.score,  *level,       {}, false,
                       from.track_id,        from.track_age_s, from.carried, {}, *box};
    const auto inside = config.whole_boxes ? std::vector<ClusterInBox>{} : clusters_in(*box, grid, clusters);
    const bool pixels_count = *level == MotionLevel::kHigh && !config.whole_boxes && !from.mask.empty();
    const auto pixels = pixels_count ? pixel_cells(from, camera, grid.shape) : std::nullopt;
    const ClusterInBox* cluster = choose_cluster(from, inside, pixels, config);
    if (cluster != nullptr) {
      cut_by_depth(object, *cluster, inside, pixels, {grid, clusters}, config);
    } else if (from.carried && !config.whole_boxes) {
      continue;
    } else {
      object.cells = all_cells(*box, grid.shape);
      if (pixels) cut_by_pixels(object, *pixels, grid.shape, [](int /*cell*/) { return false; });
    }
    objects.push_back(std::move(object));
  }
  return objects;
}

DepthClusters separate_objects(DepthClusters clusters, const std::vector<SceneObject>& objects) {
  for (const SceneObject& object : objects) {
    if (object.flat) continue;
    const std::int32_t own = clusters.count();
    clusters.cells.push_back(0);
    for (const int cell : object.cells) {
      std::int32_t& label = clusters.label[static_cast<std::size_t>(cell)];
      if (label < 0) continue;
      --clusters.cells[static_cast<std::size_t>(label)];
      ++clusters.cells[static_cast<std::size_t>(own)];
      label = own;
    }
  }
  return clusters;
}

}  // namespace rtd::filter
