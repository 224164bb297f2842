// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
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

/// Makes boxes of the outputs of one family of networks: those of one image (0 to N - 1) whose scores pass, before
/// suppression, in pixels of the input. The outputs have the shapes that it was made for. May be shared by threads.
using Decoder =
    std::function<std::vector<Candidate>(const std::vector<RawOutput>& outputs, int image, const DecodeConfig& config)>;

/// A family of networks.
struct DecoderFamily {
  const char* name;   ///< in the metadata of a file, `rtd.decoder`
  const char* title;  ///< for people
  PixelFormat pixels;
  /// A decoder for outputs of these shapes, empty when they are not this family's. Only shapes are looked at.
  Decoder (*make)(const NetworkFacts& facts, const std::vector<RawOutput>& outputs);
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

/// Decodes the output of YOLOX (decoupled heads, no anchors): one row a cell, strides 8, 16, 32, x fastest; a row is
/// x y w h objectness classes, the last two with their sigmoid applied:
///   centre = ((x, y) + cell) stride,  size = exp((w, h)) stride,  score = objectness max_c class_c.
/// Rows with a NaN in objectness, box or all classes yield nothing. `rows` are as many as the cells of `input`.
std::vector<Candidate> decode_yolox(std::span<const float> rows, InputSize input, int class_count,
                                    const DecodeConfig& config);

/// The family: one output 1 x cells x (5 + classes); pixels BGR, 0 to 255.
DecoderFamily yolox_family();

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
