// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/decoder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rtd::detector {
namespace {

constexpr int kBoxPlanes = 5;  // x y w h objectness
constexpr int kObjectnessPlane = 4;

float sigmoid(float logit) {
  return 1.0F / (1.0F + std::exp(-logit));
}

/// sigmoid(logit) >= probability as a threshold on the logit itself.
float logit_of(double probability) {
  if (probability <= 0.0) return -std::numeric_limits<float>::infinity();
  if (probability >= 1.0) return std::numeric_limits<float>::infinity();
  return static_cast<float>(std::log(probability / (1.0 - probability)));
}

struct BestClass {
  int index = -1;
  float logit = -std::numeric_limits<float>::infinity();
};

/// The largest class logit of one cell; NaN never wins.
BestClass best_class(const float* first_class_logit, std::size_t plane, int class_count) {
  BestClass best;
  for (int c = 0; c < class_count; ++c) {
    const float logit = first_class_logit[static_cast<std::size_t>(c) * plane];
    if (logit > best.logit) best = {c, logit};
  }
  return best;
}

/// A cell of one head: where it is and the logits of its anchor, `plane` floats apart.
struct Cell {
  const float* logits;
  std::size_t plane;
  int row, col, stride_px;
  Anchor anchor;
};

Candidate decode_box(const Cell& cell) {
  const auto term = [&cell](int plane_index) { return 2.0F * sigmoid(cell.logits[plane_index * cell.plane]); };
  const auto stride_px = static_cast<float>(cell.stride_px);
  const float x_px = (term(0) - 0.5F + static_cast<float>(cell.col)) * stride_px;
  const float y_px = (term(1) - 0.5F + static_cast<float>(cell.row)) * stride_px;
  const float half_width_px = 0.5F * term(2) * term(2) * cell.anchor.width_px;
  const float half_height_px = 0.5F * term(3) * term(3) * cell.anchor.height_px;
  return {0, 0, x_px - half_width_px, y_px - half_height_px, x_px + half_width_px, y_px + half_height_px};
}

int planes_per_anchor(int class_count) {
  return kBoxPlanes + class_count;
}

/// The shape of one image's head for a stride.
std::vector<int> shape_of(const HeadLayout& layout, const NetworkFacts& facts) {
  const int anchors = static_cast<int>(layout.anchors.size());
  return {1, anchors * planes_per_anchor(facts.class_count), facts.input.height_px / layout.stride_px,
          facts.input.width_px / layout.stride_px};
}

/// Gives every output the layout whose stride fits its cells, whatever the order of the outputs.
Decoder make_yolov5(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  if (outputs.size() != facts.heads.size()) return {};
  std::vector<HeadLayout> layouts(outputs.size());
  for (const HeadLayout& layout : facts.heads) {
    const auto fits = [&](const RawOutput& output) { return output.shape == shape_of(layout, facts); };
    const auto found = std::ranges::find_if(outputs, fits);
    if (found == outputs.end()) return {};
    layouts[static_cast<std::size_t>(found - outputs.begin())] = layout;
  }
  return [layouts, classes = facts.class_count](const std::vector<RawOutput>& given, int image,
                                                const DecodeConfig& config) {
    std::vector<HeadLogits> heads;
    for (std::size_t i = 0; i < given.size(); ++i)
      heads.push_back({given[i].of(image).data(), given[i].shape[2], given[i].shape[3], layouts[i]});
    return decode_heads(heads, classes, config);
  };
}

std::string yolov5_shapes(const NetworkFacts& facts) {
  std::string text;
  for (const HeadLayout& layout : facts.heads) text += (text.empty() ? "" : " ") + shape_text(shape_of(layout, facts));
  return text;
}

std::optional<int> yolov5_classes(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  if (outputs.empty() || outputs.size() != facts.heads.size() || outputs[0].shape.size() != 4) return std::nullopt;
  const int anchors = static_cast<int>(HeadLayout{}.anchors.size()), planes = outputs[0].shape[1];
  NetworkFacts guess = facts;
  guess.class_count = planes / anchors - kBoxPlanes;
  return guess.class_count > 0 && make_yolov5(guess, outputs) ? std::optional(guess.class_count) : std::nullopt;
}

}  // namespace

std::vector<Candidate> decode_heads(const std::vector<HeadLogits>& heads, int class_count, const DecodeConfig& config) {
  // The score is at most the objectness, so the confidence threshold gates the objectness too.
  const float min_logit = logit_of(std::max(config.objectness_threshold, config.confidence_threshold));
  std::vector<Candidate> candidates;
  for (const HeadLogits& head : heads) {
    const std::size_t plane = static_cast<std::size_t>(head.rows) * static_cast<std::size_t>(head.cols);
    for (std::size_t a = 0; a < head.layout.anchors.size(); ++a) {
      const float* const anchor_logits = head.logits + a * static_cast<std::size_t>(kBoxPlanes + class_count) * plane;
      const float* const objectness = anchor_logits + kObjectnessPlane * plane;
      for (std::size_t i = 0; i < plane; ++i) {
        if (!(objectness[i] >= min_logit)) continue;
        const BestClass best = best_class(anchor_logits + kBoxPlanes * plane + i, plane, class_count);
        const float score = sigmoid(objectness[i]) * sigmoid(best.logit);
        if (best.index < 0 || score < config.confidence_threshold) continue;
        const int row = static_cast<int>(i) / head.cols, col = static_cast<int>(i) % head.cols;
        Candidate candidate =
            decode_box({anchor_logits + i, plane, row, col, head.layout.stride_px, head.layout.anchors[a]});
        candidate.class_index = best.index;
        candidate.score = score;
        if (is_finite(candidate)) candidates.push_back(candidate);
      }
    }
  }
  return candidates;
}

std::vector<HeadLayout> yolov5_heads() {
  return {{8, {{{10, 13}, {16, 30}, {33, 23}}}},
          {16, {{{30, 61}, {62, 45}, {59, 119}}}},
          {32, {{{116, 90}, {156, 198}, {373, 326}}}}};
}

DecoderFamily yolov5_family() {
  return {"yolov5", "YOLOv5", {}, make_yolov5, yolov5_shapes, yolov5_classes};
}

}  // namespace rtd::detector
