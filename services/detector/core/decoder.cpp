// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/decoder.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace rtd::detector {

bool is_finite(const Candidate& box) {
  return std::isfinite(box.left_px) && std::isfinite(box.top_px) && std::isfinite(box.right_px) &&
         std::isfinite(box.bottom_px);
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

const std::vector<DecoderFamily>& decoder_families() {
  static const std::vector<DecoderFamily> families = {yolov5_family(), yolox_family(), nanodet_family()};
  return families;
}

std::string decoder_names() {
  std::string text;
  for (const DecoderFamily& family : decoder_families()) text += (text.empty() ? "" : ", ") + std::string(family.name);
  return text;
}

std::string shape_text(const std::vector<int>& shape) {
  if (shape.empty()) return "unsupported";
  std::string text;
  for (const int size : shape) text += (text.empty() ? "" : "x") + std::to_string(size);
  return text;
}

std::string shapes_text(const std::vector<RawOutput>& outputs) {
  std::string text;
  for (const RawOutput& output : outputs) text += (text.empty() ? "" : " ") + shape_text(output.shape);
  return text;
}

}  // namespace rtd::detector
