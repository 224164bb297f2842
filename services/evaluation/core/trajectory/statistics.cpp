// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rtd::eval {

Statistics summarize(const std::vector<double>& values) {
  Statistics s;
  s.count = values.size();
  if (values.empty()) return s;
  const auto n = static_cast<double>(values.size());
  s.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum_squares = 0, sum_deviations = 0;
  for (const double v : values) {
    sum_squares += v * v;
    sum_deviations += (v - s.mean) * (v - s.mean);
  }
  s.rmse = std::sqrt(sum_squares / n);
  s.std_dev = std::sqrt(sum_deviations / n);
  s.median = percentile(values, 0.5);
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  s.min = *lowest;
  s.max = *highest;
  return s;
}

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double position = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], position - static_cast<double>(below));
}

}  // namespace rtd::eval
