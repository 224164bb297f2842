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
