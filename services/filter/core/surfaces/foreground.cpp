// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/foreground.hpp"

#include <algorithm>
#include <utility>

#include "common/vision/samples.hpp"

namespace rtd::filter {
namespace {

constexpr std::size_t kEnoughFeatures = 150;  // slam begins with 100, and masks grow
constexpr float kLargestM = 2;                // a person with outstretched arms

struct Surface {
  std::vector<int> cells;
  float middle_m = 0;  ///< depth
};

bool stands_out(const Outline& outline) {
  constexpr double kMinOutline = 0.6, kMinSeen = 0.2;  // of what is known of the outline, and of all of it
  return outline.steps > 0 && outline.steps >= kMinOutline * (outline.steps + outline.flats) &&
         outline.steps >= kMinSeen * outline.all;
}

bool mostly_on(const CellMask& mask, const std::vector<int>& cells) {
  const auto on =
      std::count_if(cells.begin(), cells.end(), [&](int cell) { return mask[static_cast<std::size_t>(cell)] != 0; });
  return 2 * on > static_cast<std::ptrdiff_t>(cells.size());
}

/// Larger of width and height.
float extent_m(const std::vector<int>& cells, const Surroundings& seen) {
  Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F), high = -low;
  for (const int cell : cells) {
    const auto at = static_cast<std::size_t>(cell);
    const Eigen::Vector2f p = seen.rays[at].head<2>() * seen.grid.depth_m[at];
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).maxCoeff();
}

/// The surfaces that may be things, the nearest first.
std::vector<Surface> candidates(const Surroundings& seen, const KnownSurfaces& known) {
  std::vector<Surface> surfaces(seen.clusters.cells.size());
  for (int cell = 0; cell < seen.grid.shape.size(); ++cell) {
    const std::int32_t label = seen.clusters.label[static_cast<std::size_t>(cell)];
    if (label >= 0) surfaces[static_cast<std::size_t>(label)].cells.push_back(cell);
  }
  std::erase_if(surfaces, [&](const Surface& surface) {
    return surface.cells.empty() || mostly_on(known.decided, surface.cells) ||
           mostly_on(known.excluded, surface.cells) || extent_m(surface.cells, seen) > kLargestM;
  });
  for (Surface& surface : surfaces)
    surface.middle_m = seen.grid.depth_m[static_cast<std::size_t>(surface.cells[surface.cells.size() / 2])];
  std::stable_sort(surfaces.begin(), surfaces.end(),
                   [](const Surface& a, const Surface& b) { return a.middle_m < b.middle_m; });
  return surfaces;
}

/// Whether enough features remain without these cells, most of them farther than the surface.
bool can_spare(const Surroundings& seen, const CellMask& left_out, float middle_m) {
  std::vector<float> left_m;
  for (const msg::Feature& feature : seen.features) {
    const int cell = seen.grid.shape.nearest_cell(feature.u_px, feature.v_px);
    if (feature.depth_m > 0 && left_out[static_cast<std::size_t>(cell)] == 0) left_m.push_back(feature.depth_m);
  }
  return left_m.size() >= kEnoughFeatures && middle_m < vision::median(std::move(left_m));
}

}  // namespace

Outline outline_of(const std::vector<int>& cells, const DepthGrid& grid, double min_step_m, const OutlineMasks& masks) {
  constexpr int kReachCells = 3;
  const GridShape& shape = grid.shape;
  std::vector<char> on_surface(static_cast<std::size_t>(shape.size()), 0);
  for (const int cell : cells) on_surface[static_cast<std::size_t>(cell)] = 1;
  Outline outline;
  for (const int cell : cells) {
    const int column = cell % shape.columns, row = cell / shape.columns;
    const float z = grid.depth_m[static_cast<std::size_t>(cell)];
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int x = column + dx, y = row + dy, far_x = column + kReachCells * dx, far_y = row + kReachCells * dy;
      if (far_x < 0 || far_y < 0 || far_x >= shape.columns || far_y >= shape.rows) continue;
      const auto outside = static_cast<std::size_t>(shape.index(far_x, far_y));
      if (on_surface[static_cast<std::size_t>(shape.index(x, y))] != 0 || on_surface[outside] != 0) continue;
      if (masks.ignored != nullptr && (*masks.ignored)[outside] != 0) continue;
      ++outline.all;
      const float z_outside = grid.depth_m[outside];
      if (z_outside <= 0 || z_outside < z - min_step_m) continue;  // unknown, or the surface itself is partly hidden
      if (z_outside > z + min_step_m) {
        ++outline.steps;
      } else if (masks.things == nullptr || (*masks.things)[outside] == 0) {
        ++outline.flats;
      }
    }
  }
  return outline;
}

double outline_step_share(const std::vector<int>& cells, const DepthGrid& grid, double min_step_m) {
  const Outline outline = outline_of(cells, grid, min_step_m);
  const int known = outline.steps + outline.flats;
  return known == 0 ? 1.0 : static_cast<double>(outline.steps) / known;
}

/// A thing next to a person, or next to another thing at the same depth, stands out once that is left out.
CellMask surfaces_in_question(const Surroundings& seen, const KnownSurfaces& known, double min_step_m) {
  std::vector<Surface> waiting = candidates(seen, known);
  CellMask left_out(known.excluded), in_question(left_out.size(), 0), things(left_out.size(), 0);
  for (const Surface& surface : waiting) {
    for (const int cell : surface.cells) things[static_cast<std::size_t>(cell)] = 1;
  }
  const auto take = [&](const Surface& surface) {
    if (!mostly_on(known.asked, surface.cells) &&
        !stands_out(outline_of(surface.cells, seen.grid, min_step_m, {&left_out, &things})))
      return false;
    CellMask without(left_out);
    for (const int cell : surface.cells) without[static_cast<std::size_t>(cell)] = 1;
    if (!can_spare(seen, without, surface.middle_m)) return false;
    left_out = std::move(without);
    for (const int cell : surface.cells) in_question[static_cast<std::size_t>(cell)] = 1;
    return true;
  };
  while (std::erase_if(waiting, take) > 0) {
  }
  return in_question;
}

}  // namespace rtd::filter
