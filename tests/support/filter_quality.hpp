// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "services/evaluation/core/removal/removal.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "tests/support/evaluation_clip.hpp"

namespace rtd::test_support {

/// How well a filter separated moving from static features on a clip with true masks.
struct FilterQuality : eval::RemovalQuality {
  std::size_t frames = 0;
  double max_pose_error_m = 0;                        ///< of the filter's own pose estimate, no slam around it
  std::array<double, msg::kFilterStages> stage_ms{};  ///< means

  double removed_wrongly_per_frame() const {
    return static_cast<double>(removed_wrongly) / static_cast<double>(frames);
  }
};

/// Runs the filter alone over a clip: no detector, no slam. `on_frame` may be empty.
FilterQuality measure_filter(
    const EvaluationClip& clip, const filter::FilterConfig& config,
    const std::function<void(const vision::RgbdImage&, const filter::FilterResult&)>& on_frame = {});

}  // namespace rtd::test_support
