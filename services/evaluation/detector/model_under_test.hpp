// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "services/detector/core/detector.hpp"
#include "services/evaluation/detector/eval_detector_command.hpp"

namespace rtd::eval {

/// Properties of a model file.
struct ModelFacts {
  std::string name;  ///< file name
  double size_mb = 0;
  double parameters_m = 0;
  int input_width_px = 0, input_height_px = 0;
  double median_ms = 0;  ///< CPU time of one image on one thread, independent of the load
};

/// One of the compared models.
class ModelUnderTest {
 public:
  /// Keeps detections with a score of at least `least_score`. Without class names, those of the file are used. Throws
  /// ModelError when the file is missing or broken.
  ModelUnderTest(const std::string& path, double least_score, const std::vector<std::string>& class_names);

  std::vector<vision::Detection> detect(const cv::Mat& image, double roll_rad = 0);
  /// Measures the time of one image with the thresholds of rtd-detector.
  void take_time(const cv::Mat& image);

  ModelFacts facts() const;
  const std::vector<std::string>& class_names() const { return detector_.config().class_names; }

 private:
  ModelFacts facts_;
  detector::Detector detector_, timed_;
  std::vector<double> ms_;
};

/// All models of the options, or the default one. Throws service::ConfigError when one is missing or broken.
std::vector<ModelUnderTest> load_models(const EvalDetectorOptions& options, double least_score);

}  // namespace rtd::eval
