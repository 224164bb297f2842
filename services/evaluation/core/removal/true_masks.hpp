// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/core/removal/removal_quality.hpp"
#include "services/evaluation/record/run_record.hpp"

namespace rtd::launcher {

/// The features of one frame of a run, without what the removal is not judged by: 12 bytes each.
struct JudgedFrame {
  std::int64_t stamp_ns = 0;
  std::vector<eval::JudgedFeature> features;
};

/// The source knows which pixels move: a TUM folder with mask/ (named by the stamps of the colour images), or a
/// synthetic scene.
bool has_true_masks(const std::string& source_uri);

/// A scene takes as long to render again as it took the first time.
struct JudgeLimits {
  std::size_t most_frames = std::numeric_limits<std::size_t>::max();  ///< of more, as many are judged evenly spread
  std::function<bool()> go_on;                                        ///< asked before each frame; empty: always
};

/// Compares a run with the true masks of its source; empty when that has none. `frames` in order of time. Frames
/// without a mask of their stamp are left out. Reading them again is done behind the run, not during it.
std::optional<RunRemoval> judge_removal(const std::string& source_uri, const std::vector<JudgedFrame>& frames,
                                        const JudgeLimits& limits = {});

}  // namespace rtd::launcher
