// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/pointwise_head.hpp"

#include <algorithm>
#include <utility>

namespace rtd::detector {
namespace {

constexpr std::size_t kObjectnessPlane = 4;

}  // namespace

PointwiseHead::PointwiseHead(const float* weights, std::vector<float> bias, std::size_t channels,
                             std::size_t planes_per_anchor)
    : channels_(channels),
      planes_per_anchor_(planes_per_anchor),
      bias_(std::move(bias)),
      weights_(bias_.size() * channels) {
  for (std::size_t plane = 0; plane < bias_.size(); ++plane) {
    const std::size_t anchor = plane / planes_per_anchor, within = plane % planes_per_anchor;
    for (std::size_t c = 0; c < channels; ++c) {
      weights_[(anchor * channels + c) * planes_per_anchor + within] = weights[plane * channels + c];
    }
  }
}

void PointwiseHead::evaluate(const float* features, std::size_t cells, float min_objectness_logit,
                             float* logits) const {
  evaluate_objectness(features, cells, logits);
  for (std::size_t anchor = 0; anchor * planes_per_anchor_ < planes(); ++anchor) {
    float* const anchor_logits = logits + anchor * planes_per_anchor_ * cells;
    const float* const objectness = anchor_logits + kObjectnessPlane * cells;
    for (std::size_t i = 0; i < cells; ++i) {
      if (objectness[i] >= min_objectness_logit) evaluate_cell(features + i, cells, anchor, anchor_logits + i);
    }
  }
}

void PointwiseHead::evaluate_objectness(const float* features, std::size_t cells, float* logits) const {
  for (std::size_t anchor = 0; anchor * planes_per_anchor_ < planes(); ++anchor) {
    const std::size_t plane = anchor * planes_per_anchor_ + kObjectnessPlane;
    float* const objectness = logits + plane * cells;
    std::fill_n(objectness, cells, bias_[plane]);
    for (std::size_t c = 0; c < channels_; ++c) {
      const float weight = weights_[(anchor * channels_ + c) * planes_per_anchor_ + kObjectnessPlane];
      const float* const channel = features + c * cells;
      for (std::size_t i = 0; i < cells; ++i) objectness[i] += weight * channel[i];
    }
  }
}

/// All planes but the objectness of one cell; `features` and `cell_logits` point at its first channel and plane.
void PointwiseHead::evaluate_cell(const float* features, std::size_t cells, std::size_t anchor,
                                  float* cell_logits) const {
  const auto first_bias = bias_.begin() + static_cast<std::ptrdiff_t>(anchor * planes_per_anchor_);
  std::vector<float> sums(first_bias, first_bias + static_cast<std::ptrdiff_t>(planes_per_anchor_));
  for (std::size_t c = 0; c < channels_; ++c) {
    const float feature = features[c * cells];
    const float* const weights = weights_.data() + (anchor * channels_ + c) * planes_per_anchor_;
    for (std::size_t plane = 0; plane < planes_per_anchor_; ++plane) sums[plane] += weights[plane] * feature;
  }
  for (std::size_t plane = 0; plane < planes_per_anchor_; ++plane) {
    if (plane != kObjectnessPlane) cell_logits[plane * cells] = sums[plane];
  }
}

}  // namespace rtd::detector
