// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/vision/detection.hpp"

namespace rtd::detector {

/// How far the boxes of two engines may differ.
struct AgreementLimits {
  double box_px = 0.5, score = 1e-3;
};

/// Why two engines do not agree on an image: a box that only one of them has, or whose place or score differs. Empty
/// when they agree. Boxes within `limits.score` of the confidence threshold may be missing from one.
std::string disagreement(const std::vector<vision::Detection>& expected, const std::vector<vision::Detection>& actual,
                         double confidence_threshold, const AgreementLimits& limits = {});

/// On how many images two engines agree.
struct AgreementCount {
  std::size_t images = 0, agreeing = 0;
  std::string first_difference;  ///< of the first image on which they do not agree

  /// Counts one image with what disagreement() says of it.
  void add(const std::string& difference);
};

}  // namespace rtd::detector
