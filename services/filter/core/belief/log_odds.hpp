// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace rtd::filter {

/// l = log(p / (1 - p)): independent pieces of evidence add up, 0 means "as likely as not".
inline float log_odds(double probability) {
  constexpr double kNearlyCertain = 1e-6;
  const double p = std::clamp(probability, kNearlyCertain, 1 - kNearlyCertain);
  return static_cast<float>(std::log(p / (1 - p)));
}

inline float probability(float log_odds) {
  return 1.0F / (1.0F + std::exp(-log_odds));
}

}  // namespace rtd::filter
