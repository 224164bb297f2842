// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/assignment.hpp"

#include <cmath>
#include <limits>

namespace rtd::filter {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Grows the assignment row by row; each new row finds the cheapest chain of changes that ends at a free column.
/// Columns after the real ones stand for unassigned rows, one for each row.
class AugmentingPaths {
 public:
  AugmentingPaths(const CostMatrix& costs, double max_cost)
      : costs_(costs),
        max_cost_(max_cost),
        columns_(static_cast<std::size_t>(costs.columns + costs.rows)),
        row_price_(static_cast<std::size_t>(costs.rows), 0.0),
        column_price_(columns_, 0.0),
        row_of_(columns_, kNone) {}

  void add(int row) {
    std::vector<double> distance(columns_, kInfinity);
    std::vector<int> reached_from(columns_, kNone);  // the column whose row leads here
    std::vector<char> done(columns_, 0);
    int current_row = row, current = kNone;
    double so_far = 0;
    while (current_row != kNone) {
      int next = kNone;
      for (std::size_t j = 0; j < columns_; ++j) {
        if (done[j] != 0) continue;
        const double via = so_far + price(current_row, static_cast<int>(j)) -
                           row_price_[static_cast<std::size_t>(current_row)] - column_price_[j];
        if (via < distance[j]) {
          distance[j] = via;
          reached_from[j] = current;
        }
        if (next == kNone || distance[j] < distance[static_cast<std::size_t>(next)]) next = static_cast<int>(j);
      }
      current = next;  // there always is one: the row's own place is always open to it
      so_far = distance[static_cast<std::size_t>(current)];
      done[static_cast<std::size_t>(current)] = 1;
      current_row = row_of_[static_cast<std::size_t>(current)];
    }
    update_prices(row, distance, done, so_far);
    augment(row, current, reached_from);
  }

  std::vector<int> column_of_row() const {
    std::vector<int> result(static_cast<std::size_t>(costs_.rows), kNone);
    for (int column = 0; column < costs_.columns; ++column) {
      const int row = row_of_[static_cast<std::size_t>(column)];
      if (row != kNone) result[static_cast<std::size_t>(row)] = column;
    }
    return result;
  }

 private:
  static constexpr int kNone = -1;

  double price(int row, int column) const {
    if (column >= costs_.columns) return column - costs_.columns == row ? max_cost_ : kInfinity;
    const double cost = costs_.at(row, column);
    return std::isfinite(cost) && cost < max_cost_ ? cost : kInfinity;
  }
  /// Keeps all reduced costs >= 0 and those of the assignment 0.
  void update_prices(int row, const std::vector<double>& distance, const std::vector<char>& done, double total) {
    row_price_[static_cast<std::size_t>(row)] += total;
    for (std::size_t j = 0; j < columns_; ++j) {
      if (done[j] == 0) continue;
      const double slack = total - distance[j];
      column_price_[j] -= slack;
      if (row_of_[j] != kNone) row_price_[static_cast<std::size_t>(row_of_[j])] += slack;
    }
  }
  void augment(int row, int column, const std::vector<int>& reached_from) {
    while (column != kNone) {
      const int before = reached_from[static_cast<std::size_t>(column)];
      row_of_[static_cast<std::size_t>(column)] = before == kNone ? row : row_of_[static_cast<std::size_t>(before)];
      column = before;
    }
  }

  const CostMatrix& costs_;
  double max_cost_;
  std::size_t columns_;
  std::vector<double> row_price_, column_price_;
  std::vector<int> row_of_;  ///< per column
};

}  // namespace

CostMatrix::CostMatrix(int row_count, int column_count)
    : rows(row_count),
      columns(column_count),
      cost(static_cast<std::size_t>(row_count) * static_cast<std::size_t>(column_count), kInfinity) {}

std::vector<int> assign(const CostMatrix& costs, double max_cost) {
  AugmentingPaths paths(costs, max_cost);
  for (int row = 0; row < costs.rows; ++row) paths.add(row);
  return paths.column_of_row();
}

}  // namespace rtd::filter
