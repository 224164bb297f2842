// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/vision/detection.hpp"
#include "services/detector/core/detector.hpp"

namespace rtd::detector {

/// How far the boxes of two engines may differ.
struct AgreementLimits {
  double box_px = 0.5, score = 1e-3;
};

/// Why two engines do not agree on an image: a box that only one of them has, or whose place or score differs. Empty
/// when they agree. Boxes within `limits.score` of the confidence threshold may be missing from one.
std::string disagreement(const std::vector<vision::Detection>& expected, const std::vector<vision::Detection>& actual,
                         double confidence_threshold, const AgreementLimits& limits = {});

/// On how many images two engines agree.
struct AgreementCount {
  std::size_t images = 0, agreeing = 0;
  std::string first_difference;  ///< of the first image on which they do not agree

  /// Counts one image with what disagreement() says about it.
  void add(const std::string& difference);
};

/// A detector that continues with the CPU when the engine asked for is not there. Not thread-safe.
class EngineGuard {
 public:
  /// Throws ModelError; EngineError only for an engine whose name is wrong.
  explicit EngineGuard(DetectorConfig config);

  std::vector<vision::Detection> detect(const cv::Mat& color_bgr) { return detector_->detect(color_bgr); }
  std::vector<std::vector<vision::Detection>> detect_batch(std::span<const cv::Mat> images) {
    return detector_->detect_batch(images);
  }

  /// Runs a batch that compiles what its size needs. Throws std::invalid_argument as Detector::detect_batch() does;
  /// falls back when the engine fails.
  void warm_up(std::span<const cv::Mat> images);

  const Detector& detector() const { return *detector_; }
  /// Why the CPU is used in place of the engine asked for; empty while it is not.
  const std::string& fallback() const { return fallback_; }

 private:
  void fall_back(const std::string& cause);

  DetectorConfig on_cpu_;
  std::unique_ptr<Detector> detector_;
  std::string fallback_;
};

}  // namespace rtd::detector
