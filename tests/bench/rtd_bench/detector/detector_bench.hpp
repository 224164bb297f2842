// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "services/detector/core/detector.hpp"
#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/onnx_file.hpp"
#include "tests/bench/rtd_bench/detector/fleet_bench.hpp"

namespace rtd::bench {

/// One row of the table.
struct DetectorCase {
  std::string engine;  ///< detector::parse_engine()
  int batch = 1;       ///< images that are computed at once
};

struct DetectorOptions {
  std::string model_path;
  std::vector<std::string> engines = {"cpu"};
  std::vector<int> batches = {1};
  int threads = 1;          ///< of engines that compute on the CPU
  std::string onnxruntime;  ///< library that the engine auto may load; empty: none
};

/// For one of the engines.
detector::DetectorConfig config_of(const DetectorOptions& options, const std::string& engine);

/// What one engine did with batches of one size, each from the images to their boxes.
struct DetectorResult {
  DetectorCase what;
  std::string device;             ///< that computed, for people
  double load_s = 0;              ///< until the network had run once
  std::vector<double> batch_ms;   ///< time on the wall of each batch
  double cpu_ms_per_image = 0;    ///< of this process, all threads
  std::size_t boxes = 0;          ///< found on the images of `agreement`
  detector::AgreementCount same;  ///< with the boxes of engine cpu, one image at a time
  std::string failure;            ///< why there are no figures; empty: there are

  double ms_per_image() const;  ///< median
  double images_per_s() const;  ///< mean
};

struct DetectorComparison {
  std::string model;          ///< file name
  detector::InputSize input;  ///< of the network
  std::size_t images = 0;
  int threads = 1;
  std::vector<DetectorResult> cases;
  FleetLoad load;
  std::vector<FleetResult> fleet;  ///< with several robots
};

/// Each engine with batches of each size. The engines take turns, batch by batch, so that all of them meet the same
/// load of the host; the first batch of each is not counted. An engine or device that is not there, or a batch that
/// fails, is a failure of its case. Throws detector::ModelError, detector::EngineError for an engine's name that is
/// wrong, and std::invalid_argument without images. `on_batch` is called after each of the batches_of() batches.
DetectorComparison bench_detector(std::span<const cv::Mat> images, const DetectorOptions& options,
                                  const std::function<void()>& on_batch);
/// Number of batches that are computed when no case fails.
std::size_t batches_of(std::size_t images, const DetectorOptions& options);

/// A table for people, and the same as JSON text.
std::string detector_table(const DetectorComparison& comparison);
std::string detector_json(const DetectorComparison& comparison);

}  // namespace rtd::bench
