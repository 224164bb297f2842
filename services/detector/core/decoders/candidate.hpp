// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

/// A detected box in pixels of the network's input.
struct Candidate {
  int class_index = 0;
  float score = 0;  ///< (0, 1]
  float left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;
};

/// Whether no side of the box is infinite or NaN.
bool is_finite(const Candidate& box);

/// Greedy non-maximum suppression per class: best score first (ties: earlier candidate), a box that overlaps a kept one
/// of its class by more than config.nms_iou goes. At most config.max_detections are kept.
std::vector<Candidate> suppress_non_maxima(std::vector<Candidate> candidates, const DecodeConfig& config);

/// Intersection over union of two boxes, [0, 1]; 0 for empty boxes.
float intersection_over_union(const Candidate& a, const Candidate& b);

}  // namespace rtd::detector
