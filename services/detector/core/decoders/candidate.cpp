// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/decoders/candidate.hpp"

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

}  // namespace rtd::detector
