// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "common/service/metric_names.hpp"
#include "common/service/runtime.hpp"

/// What the services of one host do less while the computer cannot keep up. The filter chooses the step, because every
/// pose comes back to it, and names it in its heartbeat; detector and camera on the same host follow.
/// docs/operations.md, "A slow or busy computer".
namespace rtd::service {

/// One step, with all that it implies.
struct LoadStep {
  const char* name;          ///< what is shed, for people
  double feature_share;      ///< of orb.feature_count
  bool coarse_depth_check;   ///< fewer earlier views, fewer proposals for the camera's motion
  double max_detections_hz;  ///< of a detector on this host; 0 = no limit
  double max_jpeg_hz;        ///< JPEG images of the camera on this host; 0 = no limit
  int first_octave = 0;      ///< features of finer octaves are not looked for
};

inline constexpr std::array<LoadStep, 6> kLoadSteps{{
    {"", 1.0, false, 0, 0},
    {"70 % of the features, detector and JPEG at 10 Hz", 0.7, false, 10, 10},
    {"70 % of the features, coarser depth check, detector and JPEG at 5 Hz", 0.7, true, 5, 5},
    {"50 % of the features, coarser depth check, detector and JPEG at 5 Hz", 0.5, true, 5, 5},
    {"35 % of the features, coarser depth check, detector and JPEG at 3 Hz", 0.35, true, 3, 3},
    {"35 % of the features, none of the finest, coarser depth check, detector and JPEG at 3 Hz", 0.35, true, 3, 3, 3},
}};

/// What the filter on this host asks of the others; full work without one, or with a value that makes no sense.
inline const LoadStep& asked_load_step(const Heartbeat& heartbeat) {
  const double asked = heartbeat.metric_on_this_host("filter", metric::kLoadStep).value_or(0);
  if (!std::isfinite(asked)) return kLoadSteps.front();
  return kLoadSteps[static_cast<std::size_t>(std::clamp(asked, 0.0, static_cast<double>(kLoadSteps.size() - 1)))];
}

}  // namespace rtd::service
