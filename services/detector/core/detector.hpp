// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "common/vision/detection.hpp"
#include "services/detector/core/network.hpp"

namespace rtd::detector {

/// A network of one of the families (decoders/decoder.hpp) on one of the engines (engine.hpp). Not thread-safe; one
/// instance per thread.
class Detector {
 public:
  /// Loads the network and runs it once, so that the first detect() is as fast as the others.
  /// Throws ModelError when the file is missing, broken, or of no known kind; EngineError when the
  /// engine or its device is not there.
  explicit Detector(DetectorConfig config);

  /// Objects of one image, best score first; boxes in pixels of the image, clipped to it. 8-bit BGR, BGRA or grey of
  /// any size; an empty image has no objects. Throws std::invalid_argument for another pixel type.
  std::vector<vision::Detection> detect(const cv::Mat& color_bgr);

  /// The boxes of several images at once, in their order; the same as detect() of each. More than one image needs a
  /// network whose batch is free: throws std::invalid_argument that names the tool which frees it.
  std::vector<std::vector<vision::Detection>> detect_batch(std::span<const cv::Mat> images);

  InputSize input_size() const { return network_->input(); }
  /// The family of the network, for people: "YOLOX".
  const std::string& family() const { return network_->family(); }
  /// What computes the network, for people.
  const std::string& device() const { return network_->device(); }
  /// The configuration in force, with class names and heads filled in.
  const DetectorConfig& config() const { return network_->config(); }

 private:
  using BoxInFrame = std::function<cv::Rect2f(const Candidate&)>;
  std::vector<vision::Detection> boxes_of(int image, const BoxInFrame& box_of) const;

  std::unique_ptr<Network> network_;
  cv::Mat blob_, batch_;
};

}  // namespace rtd::detector
