// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "services/detector/core/decoders/decoder.hpp"

namespace rtd::detector {

/// Decodes the output of YOLOX (decoupled heads, no anchors): one row a cell, strides 8, 16, 32, x fastest; a row is
/// x y w h objectness classes, the last two with their sigmoid applied:
///   centre = ((x, y) + cell) stride,  size = exp((w, h)) stride,  score = objectness max_c class_c.
/// Rows with a NaN in objectness, box or all classes yield nothing. `rows` are as many as the cells of `input`.
std::vector<Candidate> decode_yolox(std::span<const float> rows, InputSize input, int class_count,
                                    const DecodeConfig& config);

/// The family: one output 1 x cells x (5 + classes); pixels BGR, 0 to 255.
DecoderFamily yolox_family();

}  // namespace rtd::detector
