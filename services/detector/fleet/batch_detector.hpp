// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "services/detector/core/engine_guard.hpp"

namespace rtd::detector {

/// A detector for batches. It continues with the CPU as EngineGuard does, and one image after the other when the
/// network takes no batch; device() says so. Not thread-safe.
class BatchDetector {
 public:
  /// Runs a first batch of each size up to `batch`, so that later ones are as fast as the others; on the CPU, where
  /// nothing is compiled for a size, only the largest. `verify`: as for EngineGuard. Throws ModelError; EngineError
  /// only for an engine whose name is wrong.
  BatchDetector(DetectorConfig config, int batch, bool verify = false);

  /// The boxes of each image, in the order of the images, as Detector::detect_batch().
  std::vector<std::vector<vision::Detection>> detect(std::span<const cv::Mat> images);

  /// What computes the network, for people.
  std::string device() const;
  const EngineGuard& guard() const { return guard_; }
  /// Why images are computed one by one; empty while they are not.
  const std::string& no_batch() const { return no_batch_; }

 private:
  void try_batches(int most);

  EngineGuard guard_;
  std::string no_batch_;
};

}  // namespace rtd::detector
