// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/engine_guard.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rtd::detector {
namespace {

using vision::Detection;

double distance_px(const Detection& a, const Detection& b) {
  const std::array<double, 4> sides = {a.x_px - b.x_px, a.y_px - b.y_px, a.x_px + a.width_px - b.x_px - b.width_px,
                                       a.y_px + a.height_px - b.y_px - b.height_px};
  double largest = 0;
  for (const double side : sides) largest = std::max(largest, std::abs(side));
  return largest;
}

bool same(const Detection& a, const Detection& b, const AgreementLimits& limits) {
  return a.class_name == b.class_name && std::abs(a.score - b.score) <= limits.score &&
         distance_px(a, b) <= limits.box_px;
}

/// The first clear box of `from` that `in` does not have.
const Detection* missing(const std::vector<Detection>& from, const std::vector<Detection>& in, double threshold,
                         const AgreementLimits& limits) {
  for (const Detection& wanted : from) {
    const bool clear = wanted.score > threshold + limits.score;
    const auto is_it = [&](const Detection& other) { return same(wanted, other, limits); };
    if (clear && std::ranges::none_of(in, is_it)) return &wanted;
  }
  return nullptr;
}

std::string text_of(const Detection& box) {
  return box.class_name + " " + std::to_string(box.score) + " at " + std::to_string(box.x_px) + ", " +
         std::to_string(box.y_px);
}

}  // namespace

std::string disagreement(const std::vector<Detection>& expected, const std::vector<Detection>& actual,
                         double confidence_threshold, const AgreementLimits& limits) {
  if (const Detection* const box = missing(expected, actual, confidence_threshold, limits))
    return "it does not find " + text_of(*box);
  if (const Detection* const box = missing(actual, expected, confidence_threshold, limits))
    return "it finds " + text_of(*box) + ", which is not there";
  return {};
}

void AgreementCount::add(const std::string& difference) {
  ++images;
  if (difference.empty()) ++agreeing;
  if (first_difference.empty()) first_difference = difference;
}

EngineGuard::EngineGuard(DetectorConfig config) : on_cpu_(config) {
  static_cast<void>(parse_engine(config.engine));
  on_cpu_.engine = "cpu";
  try {
    detector_ = std::make_unique<Detector>(std::move(config));
  } catch (const EngineError& error) {
    fall_back(error.what());
  }
}

void EngineGuard::fall_back(const std::string& cause) {
  fallback_ = cause;
  detector_ = std::make_unique<Detector>(on_cpu_);
}

void EngineGuard::warm_up(std::span<const cv::Mat> images) {
  try {
    detector_->detect_batch(images);
  } catch (const EngineError& error) {
    fall_back(error.what());
  }
}

}  // namespace rtd::detector
