// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/decoder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rtd::detector {
namespace {

constexpr int kSides = 4, kMinBins = 2, kMaxBins = 32;
constexpr int kUsualBins = 8;

/// A cell of a head: its logits are `plane` floats apart.
struct DistanceCell {
  const DistanceHead& head;
  const float* logits;
  std::size_t plane;
  int row, col;
};

float probability_of(float logit) {
  return 1.0F / (1.0F + std::exp(-logit));
}

/// The class with the largest logit and its score; NaN never wins.
Candidate most_likely_class(const DistanceCell& cell, int class_count) {
  Candidate best{-1, -std::numeric_limits<float>::infinity(), 0, 0, 0, 0};
  for (int c = 0; c < class_count; ++c) {
    const float logit = cell.logits[static_cast<std::size_t>(c) * cell.plane];
    if (logit > best.score) best = {c, logit, 0, 0, 0, 0};
  }
  best.score = probability_of(best.score);
  return best;
}

/// The mean of the distribution of a side's distance.
float distance_px(const DistanceCell& cell, int class_count, int side) {
  const float* const first = cell.logits + static_cast<std::size_t>(class_count + side * cell.head.bins) * cell.plane;
  const auto bin = [&](int k) { return first[static_cast<std::size_t>(k) * cell.plane]; };
  float largest = bin(0), sum = 0, weighted = 0;
  for (int k = 1; k < cell.head.bins; ++k) largest = std::max(largest, bin(k));
  for (int k = 0; k < cell.head.bins; ++k) {
    const float weight = std::exp(bin(k) - largest);
    sum += weight;
    weighted += weight * static_cast<float>(k);
  }
  return weighted / sum * static_cast<float>(cell.head.stride_px);
}

void place_box(const DistanceCell& cell, int class_count, Candidate& box) {
  const auto stride_px = static_cast<float>(cell.head.stride_px);
  const float x_px = (static_cast<float>(cell.col) + 0.5F) * stride_px;
  const float y_px = (static_cast<float>(cell.row) + 0.5F) * stride_px;
  box.left_px = x_px - distance_px(cell, class_count, 0);
  box.top_px = y_px - distance_px(cell, class_count, 1);
  box.right_px = x_px + distance_px(cell, class_count, 2);
  box.bottom_px = y_px + distance_px(cell, class_count, 3);
}

/// The bins that heads of so many planes have; 0 when there is no such number.
int bins_in(int planes, int class_count) {
  const int bins = (planes - class_count) / kSides;
  return class_count + kSides * bins == planes && bins >= kMinBins && bins <= kMaxBins ? bins : 0;
}

std::vector<int> head_shape(const NetworkFacts& facts, int planes, int stride_px) {
  return {1, planes, facts.input.height_px / stride_px, facts.input.width_px / stride_px};
}

/// The strides of the outputs, in their order; empty when they are not one head for each stride.
std::vector<int> strides_of(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  if (outputs.size() != kStrides.size() || outputs[0].shape.size() != kSides) return {};
  const int planes = outputs[0].shape[1];
  std::vector<int> strides_px(outputs.size());
  for (const int stride_px : kStrides) {
    const auto found = std::ranges::find(outputs, head_shape(facts, planes, stride_px), &RawOutput::shape);
    if (found == outputs.end()) return {};
    strides_px[static_cast<std::size_t>(found - outputs.begin())] = stride_px;
  }
  return strides_px;
}

Decoder make_nanodet(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  const std::vector<int> strides_px = strides_of(facts, outputs);
  const int bins = strides_px.empty() ? 0 : bins_in(outputs[0].shape[1], facts.class_count);
  if (bins == 0) return {};
  return [strides_px, bins, classes = facts.class_count](const std::vector<RawOutput>& given, int image,
                                                         const DecodeConfig& config) {
    std::vector<DistanceHead> heads;
    for (std::size_t i = 0; i < given.size(); ++i)
      heads.push_back({given[i].of(image).data(), given[i].shape[2], given[i].shape[3], strides_px[i], bins});
    return decode_nanodet(heads, classes, config);
  };
}

std::string nanodet_shapes(const NetworkFacts& facts) {
  std::string text;
  for (const int stride_px : kStrides)
    text += shape_text(head_shape(facts, facts.class_count + kSides * kUsualBins, stride_px)) + ' ';
  return text + "(" + std::to_string(kUsualBins) + " bins)";
}

/// Only for 80 classes and the published numbers of bins: other sums have many solutions.
std::optional<int> nanodet_classes(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  constexpr int kCocoClasses = 80;
  constexpr std::array<int, 2> kPublishedBins = {8, 11};
  if (strides_of(facts, outputs).empty()) return std::nullopt;
  const int bins = bins_in(outputs[0].shape[1], kCocoClasses);
  const bool published = std::ranges::find(kPublishedBins, bins) != kPublishedBins.end();
  return published ? std::optional(kCocoClasses) : std::nullopt;
}

}  // namespace

std::vector<Candidate> decode_nanodet(const std::vector<DistanceHead>& heads, int class_count,
                                      const DecodeConfig& config) {
  const auto least_score = static_cast<float>(config.confidence_threshold);
  std::vector<Candidate> candidates;
  for (const DistanceHead& head : heads) {
    const int cells = head.rows * head.cols;
    for (int i = 0; i < cells; ++i) {
      const DistanceCell cell{head, head.logits + i, static_cast<std::size_t>(cells), i / head.cols, i % head.cols};
      Candidate box = most_likely_class(cell, class_count);
      if (box.class_index < 0 || !(box.score >= least_score)) continue;
      place_box(cell, class_count, box);
      if (is_finite(box)) candidates.push_back(box);
    }
  }
  return candidates;
}

DecoderFamily nanodet_family() {
  const PixelFormat pixels{
      .rgb = false, .offset = {103.53F, 116.28F, 123.675F}, .scale = {1.0F / 57.375F, 1.0F / 57.12F, 1.0F / 58.395F}};
  return {"nanodet", "NanoDet", pixels, make_nanodet, nanodet_shapes, nanodet_classes};
}

}  // namespace rtd::detector
