// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/yolo_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace rtd::detector {
namespace {

constexpr int kBoxPlanes = 5;  // x y w h objectness

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

bool is_finite(const Candidate& box) {
  return std::isfinite(box.left_px) && std::isfinite(box.top_px) && std::isfinite(box.right_px) &&
         std::isfinite(box.bottom_px);
}

}  // namespace

float objectness_gate(const DecodeConfig& config) {
  return logit_of(std::max(config.objectness_threshold, config.confidence_threshold));
}

std::vector<Candidate> decode_heads(const std::vector<HeadLogits>& heads, int class_count, const DecodeConfig& config) {
  const float min_logit = objectness_gate(config);
  std::vector<Candidate> candidates;
  for (const HeadLogits& head : heads) {
    const std::size_t plane = static_cast<std::size_t>(head.rows) * static_cast<std::size_t>(head.cols);
    for (std::size_t a = 0; a < head.layout.anchors.size(); ++a) {
      const float* const anchor_logits = head.logits + a * static_cast<std::size_t>(kBoxPlanes + class_count) * plane;
      const float* const objectness = anchor_logits + 4 * plane;
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

float intersection_over_union(const Candidate& a, const Candidate& b) {
  const float width_px = std::min(a.right_px, b.right_px) - std::max(a.left_px, b.left_px);
  const float height_px = std::min(a.bottom_px, b.bottom_px) - std::max(a.top_px, b.top_px);
  if (!(width_px > 0.0F && height_px > 0.0F)) return 0.0F;
  const auto area = [](const Candidate& c) { return (c.right_px - c.left_px) * (c.bottom_px - c.top_px); };
  const float intersection = width_px * height_px;
  return intersection / (area(a) + area(b) - intersection);
}

std::vector<Candidate> suppress_non_maxima(std::vector<Candidate> candidates, const DecodeConfig& config) {
  std::ranges::stable_sort(candidates, std::ranges::greater{}, &Candidate::score);
  std::vector<Candidate> kept;
  for (const Candidate& candidate : candidates) {
    if (kept.size() >= static_cast<std::size_t>(config.max_detections)) break;
    const bool suppressed = std::ranges::any_of(kept, [&](const Candidate& better) {
      return better.class_index == candidate.class_index && intersection_over_union(better, candidate) > config.nms_iou;
    });
    if (!suppressed) kept.push_back(candidate);
  }
  return kept;
}

}  // namespace rtd::detector
