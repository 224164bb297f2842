// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/detector/core/decoders/decoder.hpp"

namespace rtd::detector {

/// The raw output of one head: `3 * (5 + classes)` planes of rows x cols logits, per anchor x y w h objectness classes.
struct HeadLogits {
  const float* logits = nullptr;
  int rows = 0, cols = 0;
  HeadLayout layout;
};

/// Decodes YOLOv5 heads (ultralytics v5, `Detect`): with s = sigmoid,
///   x = (2 s(tx) - 0.5 + column) stride,  w = (2 s(tw))^2 anchor_w,  score = s(objectness) max_c s(class_c).
/// Only cells whose objectness logit passes are looked at, so an empty image costs one comparison a cell. Cells with a
/// NaN in objectness, box or all classes yield nothing. Order: head, anchor, row, column.
std::vector<Candidate> decode_heads(const std::vector<HeadLogits>& heads, int class_count, const DecodeConfig& config);

/// The family: one output 1 x 3 (5 + classes) x rows x cols per stride, in any order; pixels RGB / 255.
DecoderFamily yolov5_family();

/// Strides and anchors of YOLOv5 and YOLOv5-Lite as published.
std::vector<HeadLayout> yolov5_heads();

}  // namespace rtd::detector
