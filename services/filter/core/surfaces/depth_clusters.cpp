// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/depth_clusters.hpp"

#include <cmath>
#include <numeric>

namespace rtd::filter {
namespace {

/// Union-find whose root is the smallest member, so that numbering does not depend on the order of joins.
class DisjointCells {
 public:
  explicit DisjointCells(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int cell) {
    while (parent_[static_cast<std::size_t>(cell)] != cell) {
      auto& parent = parent_[static_cast<std::size_t>(cell)];
      parent = parent_[static_cast<std::size_t>(parent)];
      cell = parent;
    }
    return cell;
  }
  void join(int a, int b) {
    if (parent_[static_cast<std::size_t>(a)] == parent_[static_cast<std::size_t>(b)]) return;
    a = root(a);
    b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  /// Joins a cell that is still alone with an earlier one.
  void add_to(int earlier, int cell) { parent_[static_cast<std::size_t>(cell)] = root(earlier); }

 private:
  std::vector<int> parent_;
};

void join_neighbours(const DepthGrid& grid, const ClusterConfig& config, DisjointCells& sets) {
  const auto step = static_cast<float>(config.step_m), factor = static_cast<float>(config.step_factor_per_m);
  const auto are_near = [&](int a, int b) {
    const float za = grid.depth_m[static_cast<std::size_t>(a)], zb = grid.depth_m[static_cast<std::size_t>(b)];
    const float nearer = std::min(za, zb);
    return nearer > 0 && std::abs(za - zb) < step + factor * nearer * nearer;
  };
  for (int row = 0; row < grid.shape.rows; ++row) {
    for (int column = 0; column < grid.shape.columns; ++column) {
      const int cell = grid.shape.index(column, row), above = cell - grid.shape.columns;
      if (column > 0 && are_near(cell - 1, cell)) sets.add_to(cell - 1, cell);
      if (row > 0 && are_near(above, cell)) sets.join(above, cell);
    }
  }
}

}  // namespace

DepthClusters find_depth_clusters(const DepthGrid& grid, const ClusterConfig& config) {
  const auto cells = static_cast<std::size_t>(grid.shape.size());
  DisjointCells sets(cells);
  join_neighbours(grid, config, sets);

  std::vector<int> size(cells, 0);
  std::vector<int> root(cells, -1);
  for (std::size_t i = 0; i < cells; ++i) {
    if (grid.depth_m[i] <= 0) continue;
    root[i] = sets.root(static_cast<int>(i));
    ++size[static_cast<std::size_t>(root[i])];
  }
  DepthClusters clusters{grid.shape, std::vector<std::int32_t>(cells, -1), {}};
  std::vector<std::int32_t> number(cells, -1);
  for (std::size_t i = 0; i < cells; ++i) {
    if (root[i] < 0 || size[static_cast<std::size_t>(root[i])] < config.min_cells) continue;
    auto& label = number[static_cast<std::size_t>(root[i])];
    if (label < 0) {
      label = clusters.count();
      clusters.cells.push_back(size[static_cast<std::size_t>(root[i])]);
    }
    clusters.label[i] = label;
  }
  return clusters;
}

}  // namespace rtd::filter
