// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

/// The raw output of one head: `3 * (5 + classes)` planes of rows x cols logits, per anchor x y w h objectness classes.
struct HeadLogits {
  const float* logits = nullptr;
  int rows = 0, cols = 0;
  HeadLayout layout;
};

/// A detected box in pixels of the network's input.
struct Candidate {
  int class_index = 0;
  float score = 0;  ///< objectness x class score, (0, 1]
  float left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;
};

/// The least objectness logit that decode_heads() looks at. The score is at most the objectness, so the confidence
/// threshold gates the objectness too.
float objectness_gate(const DecodeConfig& config);

/// Decodes YOLOv5 heads (ultralytics v5, `Detect`): with s = sigmoid,
///   x = (2 s(tx) - 0.5 + column) stride,  w = (2 s(tw))^2 anchor_w,  score = s(objectness) max_c s(class_c).
/// Only cells whose objectness logit passes are looked at, so an empty image costs one comparison a cell. Cells with a
/// NaN in objectness, box or all classes yield nothing. Order: head, anchor, row, column.
std::vector<Candidate> decode_heads(const std::vector<HeadLogits>& heads, int class_count, const DecodeConfig& config);

/// Greedy non-maximum suppression per class: best score first (ties: earlier candidate), a box that overlaps a kept one
/// of its class by more than config.nms_iou goes. At most config.max_detections are kept.
std::vector<Candidate> suppress_non_maxima(std::vector<Candidate> candidates, const DecodeConfig& config);

/// Intersection over union of two boxes, [0, 1]; 0 for empty boxes.
float intersection_over_union(const Candidate& a, const Candidate& b);

}  // namespace rtd::detector
