// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/engine_guard.hpp"

#include <opencv2/core.hpp>
#include <utility>

#include "services/detector/core/agreement.hpp"

namespace rtd::detector {

EngineGuard::EngineGuard(DetectorConfig config, bool verify) : on_cpu_(config) {
  static_cast<void>(parse_engine(config.engine));
  on_cpu_.engine = "cpu";
  try {
    detector_ = std::make_unique<Detector>(std::move(config));
  } catch (const EngineError& error) {
    fall_back(error.what());
    return;
  }
  const bool same = detector_->config().engine == on_cpu_.engine;
  if (verify && !same) reference_ = std::make_unique<Detector>(on_cpu_);
}

void EngineGuard::fall_back(const std::string& cause) {
  fallback_ = cause;
  detector_ = reference_ ? std::move(reference_) : std::make_unique<Detector>(on_cpu_);
}

std::vector<vision::Detection> EngineGuard::detect_upright(const cv::Mat& color_bgr, double roll_rad) {
  std::vector<vision::Detection> found = detector_->detect_upright(color_bgr, roll_rad);
  if (!reference_) return found;
  std::vector<vision::Detection> expected = reference_->detect_upright(color_bgr, roll_rad);
  return agrees(expected, found) ? found : expected;
}

std::vector<std::vector<vision::Detection>> EngineGuard::detect_batch(std::span<const cv::Mat> images) {
  const std::vector<std::vector<vision::Detection>> found = detector_->detect_batch(images);
  for (std::size_t i = 0; i < images.size() && reference_; ++i) {
    if (!agrees(reference_->detect(images[i]), found[i])) return detector_->detect_batch(images);  // now on the CPU
  }
  return found;
}

void EngineGuard::warm_up(std::span<const cv::Mat> images) {
  try {
    detector_->detect_batch(images);
  } catch (const EngineError& error) {
    fall_back(error.what());
  }
}

/// Falls back when they differ; ends the comparison after the last image.
bool EngineGuard::agrees(const std::vector<vision::Detection>& expected, const std::vector<vision::Detection>& found) {
  const std::string cause = disagreement(expected, found, on_cpu_.decode.confidence_threshold);
  if (!cause.empty()) {
    fall_back(detector_->device() + " does not agree with the CPU: " + cause);
    return false;
  }
  if (++verified_ == kVerifiedImages) reference_.reset();
  return true;
}

}  // namespace rtd::detector
