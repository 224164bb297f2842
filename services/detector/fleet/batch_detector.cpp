// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/batch_detector.hpp"

#include <stdexcept>
#include <utility>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {

BatchDetector::BatchDetector(DetectorConfig config, int batch) {
  static_cast<void>(parse_engine(config.engine));
  load(std::move(config));
  if (batch > 1) try_batch(batch);
}

void BatchDetector::load(DetectorConfig config) {
  DetectorConfig on_cpu = config;
  on_cpu.engine = "cpu";
  try {
    detector_ = std::make_unique<Detector>(std::move(config));
  } catch (const EngineError& error) {
    fallback_ = error.what();
    detector_ = std::make_unique<Detector>(std::move(on_cpu));
  }
}

void BatchDetector::try_batch(int batch) {
  const InputSize input = detector_->input_size();
  const cv::Mat grey(input.height_px, input.width_px, CV_8UC3, cv::Scalar::all(114));
  try {
    detector_->detect_batch(std::vector<cv::Mat>(static_cast<std::size_t>(batch), grey));
  } catch (const std::invalid_argument& error) {
    no_batch_ = error.what();
  }
}

std::vector<std::vector<vision::Detection>> BatchDetector::detect(std::span<const cv::Mat> images) {
  if (no_batch_.empty()) return detector_->detect_batch(images);
  std::vector<std::vector<vision::Detection>> found;
  for (const cv::Mat& image : images) found.push_back(detector_->detect(image));
  return found;
}

std::string BatchDetector::device() const {
  std::string text = detector_->device();
  if (!no_batch_.empty()) text += ", one image at a time";
  if (!fallback_.empty()) text += " in place of the engine asked for: " + fallback_;
  return text;
}

}  // namespace rtd::detector
