// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/percentile.hpp"

#include <algorithm>

namespace rtd::bench {

double percentile(std::vector<double> samples, double percent) {
  if (samples.empty()) return 0;
  const auto rank = static_cast<std::size_t>(percent / 100 * static_cast<double>(samples.size() - 1) + 0.5);
  std::nth_element(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(rank), samples.end());
  return samples[rank];
}

}  // namespace rtd::bench
