// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "services/detector/core/evaluation/average_precision.hpp"

namespace rtd::detector {

enum class Outcome : unsigned char { kWrong, kCorrect, kIgnored };

/// A detection and whether it was right, by overlap threshold.
struct JudgedDetection {
  float score = 0;
  std::array<Outcome, kIouThresholds.size()> outcome{};
};

/// Judges the 100 best detections of one image against its objects, best first.
std::vector<JudgedDetection> judge(const std::vector<vision::Detection>& detections,
                                   const std::vector<LabelledBox>& truths);

/// Intersection over union, [0, 1]; 0 for boxes without area.
double overlap(const vision::Detection& detection, const LabelledBox& truth);

}  // namespace rtd::detector
