// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/detector/core/decoders/decoder.hpp"

namespace rtd::detector {

/// The output of NanoDet's head of one stride: planes of rows x cols logits, first the classes, then for each side of
/// the box (left, top, right, bottom) the bins of a distribution of its distance.
struct DistanceHead {
  const float* logits = nullptr;
  int rows = 0, cols = 0, stride_px = 0, bins = 0;
};

/// Decodes heads of NanoDet (generalised focal loss, no anchors): with s = sigmoid,
///   score = max_c s(class_c),  distance of a side = stride sum_k k softmax(bins)_k  from the centre of the cell,
///   which is ((column, row) + 0.5) stride.
/// Cells with a NaN in the box or in all classes yield nothing.
std::vector<Candidate> decode_nanodet(const std::vector<DistanceHead>& heads, int class_count,
                                      const DecodeConfig& config);

/// The family: one output 1 x (classes + 4 bins) x rows x cols for each of the strides 8, 16, 32, in any order, with
/// the same number of bins, 2 to 32; pixels BGR, normalised by the mean and deviation of ImageNet.
DecoderFamily nanodet_family();

}  // namespace rtd::detector
