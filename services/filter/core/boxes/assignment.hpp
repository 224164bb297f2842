// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace rtd::filter {

/// What it costs to pair each row with each column; NaN and infinity: never.
struct CostMatrix {
  CostMatrix(int row_count, int column_count);
  int rows, columns;
  std::vector<double> cost;  ///< row by row
  double& at(int row, int column) {
    return cost[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
  double at(int row, int column) const {
    return cost[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
};

/// Per row its column or -1, each column at most once: the pairing with the smallest sum of costs where an unassigned
/// row costs `max_cost`; pairs that cost that much or more are never made. Exact (shortest augmenting paths: Jonker and
/// Volgenant, Computing 38, 1987), O(rows^2 (rows + columns)). Deterministic.
std::vector<int> assign(const CostMatrix& costs, double max_cost);

}  // namespace rtd::filter
