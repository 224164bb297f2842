// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace rtd::eval {

inline constexpr double kRadToDeg = 180 / std::numbers::pi;

/// Summary of a set of non-negative errors, in their unit. All NaN when count is 0.
struct Statistics {
  std::size_t count = 0;
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
  double std_dev = std::numeric_limits<double>::quiet_NaN();  ///< of the population (divided by count)
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

Statistics summarize(const std::vector<double>& values);

/// Value below which a fraction (in [0, 1]) of the values lies, linear between neighbours. NaN when there are none.
double percentile(std::vector<double> values, double fraction);

}  // namespace rtd::eval
