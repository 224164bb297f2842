// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace rtd::filter {
namespace {

/// Tries everything: the smallest sum for the rows from `row` on.
double cheapest(const CostMatrix& costs, double max_cost, int row, std::vector<char>& taken) {
  if (row == costs.rows) return 0;
  double best = max_cost + cheapest(costs, max_cost, row + 1, taken);
  for (int column = 0; column < costs.columns; ++column) {
    const double cost = costs.at(row, column);
    if (taken[static_cast<std::size_t>(column)] != 0 || !std::isfinite(cost) || cost >= max_cost) continue;
    taken[static_cast<std::size_t>(column)] = 1;
    best = std::min(best, cost + cheapest(costs, max_cost, row + 1, taken));
    taken[static_cast<std::size_t>(column)] = 0;
  }
  return best;
}

double sum_of(const CostMatrix& costs, const std::vector<int>& column_of, double max_cost) {
  double sum = 0;
  std::set<int> used;
  for (int row = 0; row < costs.rows; ++row) {
    const int column = column_of[static_cast<std::size_t>(row)];
    EXPECT_TRUE(column < 0 || used.insert(column).second) << "column twice";
    sum += column < 0 ? max_cost : costs.at(row, column);
  }
  return sum;
}

TEST(Assignment, is_as_cheap_as_the_best_of_all_possible_ones) {
  constexpr double kMaxCost = 0.7;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> cost(0, 1);
  for (int trial = 0; trial < 400; ++trial) {
    CostMatrix costs(static_cast<int>(random() % 6), static_cast<int>(random() % 7));
    for (double& value : costs.cost) value = random() % 8 == 0 ? std::numeric_limits<double>::infinity() : cost(random);
    std::vector<char> taken(static_cast<std::size_t>(costs.columns), 0);
    EXPECT_NEAR(sum_of(costs, assign(costs, kMaxCost), kMaxCost), cheapest(costs, kMaxCost, 0, taken), 1e-12)
        << "trial " << trial;
  }
}

TEST(Assignment, leaves_a_column_to_a_row_that_has_no_other_choice) {
  CostMatrix costs(2, 2);
  costs.at(0, 0) = 0.1;
  costs.at(0, 1) = 0.2;
  costs.at(1, 0) = 0.3;
  EXPECT_EQ(assign(costs, 1.0), (std::vector<int>{1, 0}));
}

TEST(Assignment, does_not_assign_rows_whose_pairs_cost_too_much_or_are_not_finite) {
  CostMatrix costs(3, 3);
  costs.at(0, 0) = 2.0;
  costs.at(1, 1) = std::nan("");
  costs.at(2, 2) = 0.5;
  EXPECT_EQ(assign(costs, 1.0), (std::vector<int>{-1, -1, 2}));
}

TEST(Assignment, accepts_empty_sides) {
  EXPECT_TRUE(assign(CostMatrix(0, 5), 1.0).empty());
  EXPECT_EQ(assign(CostMatrix(2, 0), 1.0), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace rtd::filter
