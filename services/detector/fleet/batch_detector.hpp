// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "services/detector/core/detector.hpp"

namespace rtd::detector {

/// A detector for batches. It goes on with the CPU when the engine asked for is not there, and one image after the
/// other when the network takes no batch; device() says so. Not thread-safe.
class BatchDetector {
 public:
  /// Runs a first batch of `batch` images, so that the next one is as fast as the others. Throws ModelError;
  /// EngineError only for an engine whose name is wrong.
  BatchDetector(DetectorConfig config, int batch);

  /// The boxes of each image, in the order of the images, as Detector::detect_batch().
  std::vector<std::vector<vision::Detection>> detect(std::span<const cv::Mat> images);

  /// What computes the network, for people.
  std::string device() const;
  const Detector& detector() const { return *detector_; }
  /// Why the CPU is used in place of the engine asked for; empty while it is not.
  const std::string& fallback() const { return fallback_; }
  /// Why images are computed one by one; empty while they are not.
  const std::string& no_batch() const { return no_batch_; }

 private:
  void load(DetectorConfig config);
  void try_batch(int batch);

  std::unique_ptr<Detector> detector_;
  std::string fallback_, no_batch_;
};

}  // namespace rtd::detector
