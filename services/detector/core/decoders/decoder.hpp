// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/core/onnx_file.hpp"

/// What the families of networks expect as input, and what they mean by their outputs. Engines know neither.
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

/// How a network wants its pixels: input = (pixel - offset) * scale, per channel of the input.
struct PixelFormat {
  bool rgb = true;  ///< channel 0 is red; false: blue
  std::array<float, 3> offset{};
  std::array<float, 3> scale{1.0F / 255.0F, 1.0F / 255.0F, 1.0F / 255.0F};
};

/// What is known of a network before it has run.
struct NetworkFacts {
  InputSize input;
  int class_count = 0;
  std::vector<HeadLayout> heads;  ///< YOLOv5: strides and anchors
};

/// Makes boxes of the outputs of one family of networks. Holds no state; may be shared by threads.
class Decoder {
 public:
  virtual ~Decoder() = default;
  virtual PixelFormat pixels() const = 0;
  /// The boxes of one image (0 to N - 1) whose scores pass, before suppression, in pixels of the input. The outputs
  /// have the shapes that the decoder was made for.
  virtual std::vector<Candidate> decode(const std::vector<RawOutput>& outputs, int image,
                                        const DecodeConfig& config) const = 0;
};

/// A family of networks.
struct DecoderFamily {
  const char* name;   ///< in the metadata of a file, `rtd.decoder`
  const char* title;  ///< for people
  /// A decoder for outputs of these shapes, null when they are not this family's. Only shapes are looked at.
  std::unique_ptr<Decoder> (*make)(const NetworkFacts& facts, const std::vector<RawOutput>& outputs);
  /// The shapes that it expects, for people.
  std::string (*expected)(const NetworkFacts& facts);
  /// How many classes outputs of these shapes have if they are this family's.
  std::optional<int> (*classes_in)(const NetworkFacts& facts, const std::vector<RawOutput>& outputs);
};

/// All families; no outputs fit two of them.
const std::vector<DecoderFamily>& decoder_families();

/// "yolov5, yolox, nanodet"
std::string decoder_names();

/// "1x255x60x80"; "unsupported" for an output that is not a float tensor.
std::string shape_text(const std::vector<int>& shape);
/// The shapes of all outputs, separated by spaces.
std::string shapes_text(const std::vector<RawOutput>& outputs);

/// The strides of networks without anchors.
inline constexpr std::array<int, 3> kStrides = {8, 16, 32};

}  // namespace rtd::detector
