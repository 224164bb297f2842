// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace rtd::vision {

/// The middle value, of an even number the upper one; 0 of none.
template <class T>
T median(std::vector<T> values) {
  if (values.empty()) return T{};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The elements, thinned out evenly to at most `limit`.
template <class T>
std::vector<T> thin_out(std::vector<T> all, std::size_t limit) {
  if (all.size() <= limit) return all;
  std::vector<T> kept;
  for (std::size_t i = 0; i < limit; ++i) kept.push_back(all[i * all.size() / limit]);
  return kept;
}

/// The interval without the outer twentieths of the values, of which there is at least one. Sorts them partly.
inline std::pair<double, double> spread(std::vector<double>& values) {
  const auto outer = static_cast<std::ptrdiff_t>(values.size() / 20);
  const auto low = values.begin() + outer, high = values.end() - 1 - outer;
  std::nth_element(values.begin(), low, values.end());
  const double lowest = *low;
  std::nth_element(values.begin(), high, values.end());
  return {lowest, *high};
}

}  // namespace rtd::vision
