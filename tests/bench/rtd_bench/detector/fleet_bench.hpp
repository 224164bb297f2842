// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

namespace rtd::bench {

struct DetectorOptions;

/// Robots that send JPEG images, evenly spread over time.
struct FleetLoad {
  std::vector<int> robots;  ///< one case each; none: no cases
  double rate_hz = 30;      ///< images a second of each robot
  double seconds = 4;       ///< measured, after at most one second that is not
};

/// One engine that serves so many robots, from the arrival of JPEG images in this process to their boxes.
struct FleetResult {
  std::string engine;
  int batch = 1, robots = 1;
  double least_hz = 0, mean_hz = 0;  ///< answers a second: of the robot that got least, of all robots
  double latency_p50_ms = 0, latency_p99_ms = 0;
  double batch_mean = 0;        ///< images computed together
  double cpu_percent = 0;       ///< of a core: this process, which also sends
  std::string device, failure;  ///< why there are no figures; empty: there are

  double images_per_s() const { return mean_hz * robots; }
};

/// All engines and batch sizes of the options with each number of robots, one after the other. An engine that is not
/// there or a network that takes no batch is a failure of its cases. `on_case` is called after each of them.
std::vector<FleetResult> bench_fleet(std::span<const cv::Mat> images, const DetectorOptions& options,
                                     const FleetLoad& load, const std::function<void()>& on_case);
std::size_t cases_of(const DetectorOptions& options, const FleetLoad& load);

/// A table for people; empty without results.
std::string fleet_table(const std::vector<FleetResult>& results, const FleetLoad& load);

}  // namespace rtd::bench
