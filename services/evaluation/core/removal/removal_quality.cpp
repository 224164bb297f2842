// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/removal/removal_quality.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rtd::eval {
namespace {

constexpr int kGrowPx = 3;

bool on(const cv::Mat& mask, const JudgedFeature& feature) {
  if (mask.empty()) return false;
  const auto nearest = [](float px, int count) {
    return static_cast<int>(std::lround(std::clamp(px, 0.0F, static_cast<float>(count - 1))));
  };
  return mask.at<std::uint8_t>(nearest(feature.v_raw_px, mask.rows), nearest(feature.u_raw_px, mask.cols)) != 0;
}

}  // namespace

std::vector<JudgedFeature> judged(std::span<const msg::Feature> features) {
  std::vector<JudgedFeature> result;
  result.reserve(features.size());
  for (const msg::Feature& f : features) {
    result.push_back({f.u_raw_px, f.v_raw_px, (f.flags & msg::kFeatureRemoved) != 0});
  }
  return result;
}

void RemovalQuality::count(std::span<const msg::Feature> features, const cv::Mat& moving) {
  count(judged(features), moving);
}

void RemovalQuality::count(std::span<const JudgedFeature> features, const cv::Mat& moving) {
  constexpr int kSide = 2 * kGrowPx + 1;
  cv::Mat grown;
  if (!moving.empty()) cv::dilate(moving, grown, cv::getStructuringElement(cv::MORPH_RECT, {kSide, kSide}));
  for (const JudgedFeature& feature : features) {
    if (feature.removed) {
      ++(on(grown, feature) ? removed_rightly : removed_wrongly);
    } else {
      ++(on(moving, feature) ? kept_wrongly : kept_rightly);
    }
  }
}

}  // namespace rtd::eval
