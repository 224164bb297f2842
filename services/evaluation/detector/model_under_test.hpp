// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "services/detector/core/detector.hpp"
#include "services/detector/core/person_segmenter.hpp"
#include "services/evaluation/detector/eval_detector_command.hpp"

namespace rtd::eval {

/// Properties of a model file and of the engine that computes it.
struct ModelFacts {
  std::string name;    ///< file name
  std::string engine;  ///< as asked for
  std::string device;  ///< that the engine computes on
  double size_mb = 0;
  double parameters_m = 0;
  int input_width_px = 0, input_height_px = 0;
  double median_ms = 0;  ///< CPU time of one image, all threads of this process

  /// The name, with the engine unless it is the CPU.
  std::string title() const { return engine == "cpu" ? name : name + ", " + detector::engine_label(engine); }
};

/// One of the compared models on one of the compared engines.
class ModelUnderTest {
 public:
  /// Loads the file that `config` names. Keeps detections with a score of at least `least_score`. Throws ModelError
  /// when the file is missing or broken, EngineError when the engine or its device is not there.
  ModelUnderTest(const detector::DetectorConfig& config, double least_score);

  std::vector<vision::Detection> detect(const cv::Mat& image);
  /// Measures the time of one image with the thresholds of rtd-detector.
  void take_time(const cv::Mat& image);

  ModelFacts facts() const;
  const std::string& path() const { return detector_.config().model_path; }
  const std::string& engine() const { return facts_.engine; }
  const std::vector<std::string>& class_names() const { return detector_.config().class_names; }

 private:
  ModelFacts facts_;
  detector::Detector detector_, timed_;
  std::vector<double> ms_;
};

/// All models of the options, or the default one, on each engine. Throws service::ConfigError when a model is missing
/// or broken, or an engine or its device is not there.
std::vector<ModelUnderTest> load_models(const EvalDetectorOptions& options, double least_score);

/// The network for masks on the first engine of the options; null when they name none. Throws as load_models() does.
std::unique_ptr<detector::PersonSegmenter> load_segmenter(const EvalDetectorOptions& options);

}  // namespace rtd::eval
