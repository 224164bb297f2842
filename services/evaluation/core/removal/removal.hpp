// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/run_record/run_record.hpp"

namespace cv {
class Mat;
}

namespace rtd::eval {

/// How well a filter separated moving from static features, compared with the true moving pixels. A removed feature is
/// right on the mask grown by 3 px (a feature is a patch, not a pixel); a kept feature is wrong on the mask itself.
struct RemovalQuality {
  std::uint64_t removed_rightly = 0, removed_wrongly = 0, kept_wrongly = 0, kept_rightly = 0;

  /// Adds one frame. `moving`: CV_8UC1, not 0 = moving pixel; empty = nothing moves.
  void count(std::span<const run_record::JudgedFeature> features, const cv::Mat& moving);
  /// Removed rightly of all removed; NaN when nothing was removed.
  double precision() const { return ratio(removed_rightly, removed_wrongly); }
  /// Removed rightly of all features on moving pixels; NaN when there are none.
  double recall() const { return ratio(removed_rightly, kept_wrongly); }

 private:
  static double ratio(std::uint64_t good, std::uint64_t bad) {
    if (good + bad == 0) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(good) / static_cast<double>(good + bad);
  }
};

/// The quality over a whole run, and without its first second: until then the filter has little to compare with.
struct RunRemoval {
  std::size_t frames = 0;  ///< frames whose true moving pixels are known
  RemovalQuality all, settled;
};

/// Bounds the work: rendering a scene again takes as long as the first time.
struct JudgeLimits {
  std::size_t most_frames =
      std::numeric_limits<std::size_t>::max();  ///< of more frames, some are judged, evenly spread
  std::function<bool()> go_on;                  ///< asked before each frame; empty: always
};

/// Compares a run with the true masks of its source; empty when the source has none. `frames` in order of time; frames
/// without a mask at their stamp are left out. Throws camera::SourceError when the source cannot be opened again.
std::optional<RunRemoval> judge_removal(const std::string& source_uri,
                                        const std::vector<run_record::JudgedFrame>& frames,
                                        const JudgeLimits& limits = {});

}  // namespace rtd::eval
