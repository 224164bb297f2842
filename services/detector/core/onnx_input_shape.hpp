// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace rtd::detector {

/// Height and width of an image input, px.
struct InputSize {
  int width_px = 0, height_px = 0;
};

/// What the head of an ONNX file says of its image input.
struct OnnxInput {
  bool has_graph = false;          ///< false: these bytes are no ONNX model, or only the beginning of one
  std::optional<InputSize> fixed;  ///< of the first 1x3xHxW input with fixed H and W
};

/// Reads the image input's shape out of ONNX bytes (protobuf wire format; onnx.proto: ModelProto.graph = 7,
/// GraphProto.input = 11). OpenCV 4.6 does not tell it. Never reads outside the bytes, whatever they hold.
OnnxInput read_onnx_input(const std::uint8_t* bytes, std::size_t size);

}  // namespace rtd::detector
