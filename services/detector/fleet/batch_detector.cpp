// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/batch_detector.hpp"

#include <stdexcept>
#include <utility>

namespace rtd::detector {

BatchDetector::BatchDetector(DetectorConfig config, int batch, bool verify) : guard_(std::move(config), verify) {
  if (batch > 1) try_batches(batch);
}

/// The largest first, which finds out what the memory of the device holds.
void BatchDetector::try_batches(int most) {
  const InputSize input = guard_.detector().input_size();
  const cv::Mat grey(input.height_px, input.width_px, CV_8UC3, cv::Scalar::all(114));
  const std::vector<cv::Mat> images(static_cast<std::size_t>(most), grey);
  try {
    for (std::size_t size = images.size(); size > 1; size = guard_.detector().device() == kCpuDevice ? 1 : size - 1)
      guard_.warm_up(std::span(images).first(size));
  } catch (const std::invalid_argument& error) {
    no_batch_ = error.what();
  }
}

std::vector<std::vector<vision::Detection>> BatchDetector::detect(std::span<const cv::Mat> images) {
  if (no_batch_.empty()) return guard_.detect_batch(images);
  std::vector<std::vector<vision::Detection>> found;
  for (const cv::Mat& image : images) found.push_back(guard_.detect_upright(image, 0));
  return found;
}

std::string BatchDetector::device() const {
  std::string text = guard_.detector().device();
  if (!no_batch_.empty()) text += ", one image at a time";
  if (!guard_.fallback().empty()) text += " in place of the engine asked for: " + guard_.fallback();
  return text;
}

}  // namespace rtd::detector
