// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/integrity/drift.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rtd::eval {

bool Drift::nearly_constant() const {
  constexpr std::size_t kFewest = 8;
  constexpr double kSpread = 0.15;
  return windows >= kFewest && lower_quartile_m_per_rad >= (1 - kSpread) * quotient_m_per_rad &&
         upper_quartile_m_per_rad <= (1 + kSpread) * quotient_m_per_rad;
}

Drift measure_drift(const Trajectory& estimate, const Trajectory& groundtruth, const DriftOptions& options) {
  constexpr double kLeast_rad = 1e-6;  // of a drift without a turn
  std::vector<double> translations_m, rotations_rad, quotients;
  const RpeOptions steps{options.window_s, RpeUnit::kSeconds, options.offset_s, options.scale};
  for (const auto& [translation_m, rotation_rad] : relative_errors(estimate, groundtruth, steps)) {
    if (!(translation_m > options.least_m)) continue;
    translations_m.push_back(translation_m);
    rotations_rad.push_back(rotation_rad);
    quotients.push_back(translation_m / std::max(rotation_rad, kLeast_rad));
  }
  return {quotients.size(),           percentile(translations_m, 0.5), percentile(rotations_rad, 0.5),
          percentile(quotients, 0.5), percentile(quotients, 0.25),     percentile(quotients, 0.75)};
}

std::string explain(const Drift& drift, const std::optional<double>& scene_depth_m) {
  constexpr double kNear = 0.25;  // of the scene's depth
  if (!drift.nearly_constant()) return {};
  std::string text = fmt::format(
      "nearly constant: the pose trades a sideways movement against a turn that keeps what is {:.1f} m away in place; "
      "it follows something nearer than that",
      drift.quotient_m_per_rad);
  if (!scene_depth_m) return text;
  const bool near = std::abs(drift.quotient_m_per_rad - *scene_depth_m) <= kNear * *scene_depth_m;
  return text +
         fmt::format("; the scene's depth is {:.1f} m, {}", *scene_depth_m, near ? "near that" : "not near that");
}

}  // namespace rtd::eval
