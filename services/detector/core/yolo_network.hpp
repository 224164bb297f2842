// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/onnx_file.hpp"
#include "services/detector/core/pointwise_head.hpp"
#include "services/detector/core/yolo_decoder.hpp"

namespace rtd::detector {

/// The loaded network: blob in, logits of the heads out. Not thread-safe.
class YoloNetwork {
 public:
  /// Loads config.model_path and runs it once. Throws ModelError.
  explicit YoloNetwork(DetectorConfig config);

  /// Runs the network on a blob (CV_32F, 1x3xHxW, RGB / 255). The logits of cells whose objectness does not pass
  /// objectness_gate() are undefined except for the objectness. Valid until the next call.
  const std::vector<HeadLogits>& infer(const cv::Mat& blob);

  InputSize input() const { return input_; }
  /// With class names and heads filled in.
  const DetectorConfig& config() const { return config_; }

 private:
  /// One output of the network.
  struct Branch {
    std::string layer;                  ///< whose output is asked of OpenCV: the head's input, or the output itself
    std::optional<PointwiseHead> head;  ///< computed here when the head is a 1x1 convolution
    HeadLayout layout;
    std::vector<float> logits;
  };

  void load();
  void complete_config(const OnnxFile& file);
  Branch branch_of(const std::string& output_name);
  void assign_layouts();
  std::string shape_of(std::size_t index) const;
  int planes_per_anchor() const { return static_cast<int>(5 + config_.class_names.size()); }

  DetectorConfig config_;
  InputSize input_;
  cv::dnn::Net net_;
  std::vector<Branch> branches_;
  std::vector<cv::String> layer_names_;
  std::vector<cv::Mat> outputs_;
  std::vector<HeadLogits> heads_;
};

}  // namespace rtd::detector
