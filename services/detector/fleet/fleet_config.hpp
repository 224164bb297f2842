// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <opencv2/core.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/service/runtime.hpp"
#include "common/vision/detection.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/core/fleet/fleet_queue.hpp"

namespace rtd::detector {

/// A detector for batches. It continues with the CPU as EngineGuard does, and one image after the other when the
/// network takes no batch; device() says so. Not thread-safe.
class BatchDetector {
 public:
  /// Runs a first batch of each size up to `batch`, so that later ones are as fast as the others; on the CPU, where
  /// nothing is compiled for a size, only the largest. Throws ModelError; EngineError only for an engine whose name is
  /// wrong.
  BatchDetector(DetectorConfig config, int batch);

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

struct ServiceConfig;

/// How one detector serves several robots.
struct FleetConfig {
  std::set<std::string> robots;  ///< only these; empty: all that are found
  FleetQueueConfig queue;
  int decoders = 1;
  std::size_t most_robots = 64;                 ///< others in the domain could make up names without end
  std::chrono::milliseconds stuck_after{1500};  ///< no progress for longer: other detectors take over
};

/// Threads that decode, where nothing else is configured: one for each core, up to four.
int usual_decoders();

/// Throws ConfigError for what cannot be combined with several robots, and for names that no robot can have.
FleetConfig fleet_config(const ServiceConfig& config, const service::Runtime& runtime);

/// What computes the boxes of a batch of 8-bit BGR images, of any sizes: one list for each image. Used by one thread.
struct Inference {
  std::function<std::vector<std::vector<vision::Detection>>(std::span<const cv::Mat>)> detect;
  std::function<std::string()> device;  ///< for people; may change with each batch
};

/// Loads the network. Throws ConfigError when there is none or it is broken.
Inference load_inference(const ServiceConfig& config);

}  // namespace rtd::detector
