// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
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

}  // namespace rtd::vision
