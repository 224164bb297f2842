// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/dense/grid_truth.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "common/camera/open/source_factory.hpp"
#include "common/camera/synthetic/synthetic_source.hpp"

namespace rtd::test_support {
namespace {

using camera::synthetic::Face;
using camera::synthetic::Geometry;

constexpr int kAll = 25;
constexpr float kWallsM = 1.0F;  // of the plan around the room

Eigen::AlignedBox3f static_extent(const Geometry& geometry) {
  Eigen::AlignedBox3f extent;
  for (const Face& face : geometry.faces) {
    if (face.surface.moving) continue;
    extent.extend(face.origin);
    extent.extend(face.origin + face.width_m * face.axis_s + face.height_m * face.axis_t);
  }
  return extent;
}

}  // namespace

GridTruth::GridTruth(const std::string& source, double cell_m, const occupancy::RobotHeights& heights)
    : cell_m_(cell_m), heights_(heights) {
  const camera::SyntheticOptions options = camera::parse_synthetic_options(camera::parse_source_uri(source));
  const camera::synthetic::Scene scene(options.scene, options.seed);
  const Geometry room = scene.geometry_at(0);
  const Eigen::AlignedBox3f extent = static_extent(room);
  const auto cell = static_cast<float>(cell_m);
  first_ = ((extent.min().head<2>().array() - kWallsM) / cell).floor().cast<int>();
  const Eigen::Array2i end = ((extent.max().head<2>().array() + kWallsM) / cell).ceil().cast<int>();
  columns_ = end.x() - first_.x();
  rows_ = end.y() - first_.y();
  cells_.resize(static_cast<std::size_t>(columns_ * rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const float x = static_cast<float>(first_.x() + column) + (static_cast<float>(i % kSamples) + 0.5F) / kSamples;
        const float y = static_cast<float>(first_.y() + row) + (static_cast<float>(i / kSamples) + 0.5F) / kSamples;
        cells_[static_cast<std::size_t>(row * columns_ + column)].solid += solid(room, x * cell, y * cell) ? 1 : 0;
      }
    }
  }
  for (std::uint64_t i = 0; i < options.frames; ++i) {
    mark_movers(scene.geometry_at(static_cast<double>(i) / options.fps));
  }
}

/// By the level faces of static things above and below a place: inside a thing the next one above is its upper side.
bool GridTruth::solid(const Geometry& geometry, float x_m, float y_m) const {
  const auto low_m = static_cast<float>(heights_.min_height_m), high_m = static_cast<float>(heights_.max_height_m);
  float next_m = std::numeric_limits<float>::max();
  bool upwards = true;  // outside of the room there is nothing above
  for (const Face& face : geometry.faces) {
    const Eigen::Vector3f normal = face.axis_s.cross(face.axis_t);
    if (face.surface.moving || std::abs(normal.z()) < 0.9F) continue;
    const Eigen::Vector3f from = Eigen::Vector3f(x_m, y_m, face.origin.z()) - face.origin;
    const float s = from.dot(face.axis_s), t = from.dot(face.axis_t);
    if (s < 0 || t < 0 || s > face.width_m || t > face.height_m || face.origin.z() <= low_m) continue;
    if (face.origin.z() < high_m) return true;
    if (face.origin.z() >= next_m) continue;
    next_m = face.origin.z();
    upwards = normal.z() > 0;
  }
  return upwards;
}

void GridTruth::mark_movers(const Geometry& geometry) {
  for (const auto& ellipsoid : geometry.ellipsoids) {
    if (!ellipsoid.surface.moving) continue;
    const Eigen::Vector3f reach =
        (ellipsoid.T_world_body.linear() * ellipsoid.semi_axes_m.asDiagonal()).rowwise().norm();
    const Eigen::Vector3f center = ellipsoid.T_world_body.translation();
    mark(Eigen::AlignedBox3f(center - reach, center + reach));
  }
  for (const Face& face : geometry.faces) {
    if (!face.surface.moving) continue;
    Eigen::AlignedBox3f box(face.origin);
    box.extend(face.origin + face.width_m * face.axis_s);
    box.extend(face.origin + face.height_m * face.axis_t);
    box.extend(face.origin + face.width_m * face.axis_s + face.height_m * face.axis_t);
    mark(box);
  }
}

void GridTruth::mark(const Eigen::AlignedBox3f& box) {
  if (static_cast<double>(box.max().z()) < heights_.min_height_m) return;
  if (static_cast<double>(box.min().z()) > heights_.max_height_m) return;
  const auto cell = static_cast<float>(cell_m_);
  const Eigen::Array2i low = (box.min().head<2>() / cell).array().floor().cast<int>() - first_.array();
  const Eigen::Array2i high = (box.max().head<2>() / cell).array().floor().cast<int>() - first_.array();
  for (int row = std::max(0, low.y()); row <= std::min(rows_ - 1, high.y()); ++row) {
    for (int column = std::max(0, low.x()); column <= std::min(columns_ - 1, high.x()); ++column) {
      cells_[static_cast<std::size_t>(row * columns_ + column)].visited = true;
    }
  }
}

const GridTruth::Cell& GridTruth::at(const Eigen::Vector2i& cell) const {
  static const Cell kOutside{kAll, false};
  const Eigen::Vector2i at = cell - first_;
  if (at.x() < 0 || at.y() < 0 || at.x() >= columns_ || at.y() >= rows_) return kOutside;
  return cells_[static_cast<std::size_t>(at.y() * columns_ + at.x())];
}

template <class Is>
bool GridTruth::all_around(const Eigen::Vector2i& cell, Is is) const {
  for (int i = 0; i < 9; ++i) {
    if (!is(at(cell + Eigen::Vector2i(i % 3 - 1, i / 3 - 1)))) return false;
  }
  return true;
}

GridReport GridTruth::judge(const occupancy::NavigationGrid& grid) const {
  GridReport report;
  for (const Cell& cell : cells_) report.truly_free += cell.solid == 0 ? 1 : 0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2i cell = grid.first + Eigen::Vector2i(column, row);
      const Cell& truth = at(cell);
      if (grid.at(cell) == occupancy::NavigationGrid::kFree) {
        ++report.free;
        report.wrong_free += all_around(cell, [](const Cell& c) { return c.solid == kAll; }) ? 1 : 0;
        report.mostly_wrong_free += 2 * truth.solid > kAll ? 1 : 0;
        report.found_free += truth.solid == 0 ? 1 : 0;
      } else if (grid.at(cell) == occupancy::NavigationGrid::kOccupied) {
        ++report.occupied;
        const bool wrong = all_around(cell, [](const Cell& c) { return c.solid == 0; });
        report.wrong_occupied += wrong ? 1 : 0;
        report.ghosts += wrong && !all_around(cell, [](const Cell& c) { return !c.visited; }) ? 1 : 0;
        report.wholly_wrong_occupied += truth.solid == 0 ? 1 : 0;
      }
    }
  }
  return report;
}

}  // namespace rtd::test_support
