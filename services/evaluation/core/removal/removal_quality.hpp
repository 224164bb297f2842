// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/msg/features.hpp"

namespace cv {
class Mat;
}

namespace rtd::eval {

/// What counts of a feature here.
struct JudgedFeature {
  float u_raw_px = 0, v_raw_px = 0;  ///< pixel of the camera's own image
  bool removed = false;
};
std::vector<JudgedFeature> judged(std::span<const msg::Feature> features);

/// How well moving and static features were told apart, against the true moving pixels. A feature counts as removed
/// rightly on the mask grown by 3 px (a feature is a patch, not a pixel), as kept wrongly on the mask itself.
struct RemovalQuality {
  std::uint64_t removed_rightly = 0, removed_wrongly = 0, kept_wrongly = 0, kept_rightly = 0;

  /// Adds one frame. `moving`: CV_8UC1, not 0 = moving pixel; empty = nothing moves.
  void count(std::span<const JudgedFeature> features, const cv::Mat& moving);
  void count(std::span<const msg::Feature> features, const cv::Mat& moving);
  /// Removed rightly of all removed; NaN when nothing was removed.
  double precision() const { return ratio(removed_rightly, removed_wrongly); }
  /// Removed rightly of all that had to be; NaN when nothing had to be.
  double recall() const { return ratio(removed_rightly, kept_wrongly); }

 private:
  static double ratio(std::uint64_t good, std::uint64_t bad) {
    if (good + bad == 0) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(good) / static_cast<double>(good + bad);
  }
};

}  // namespace rtd::eval
