// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/onnx_file.hpp"
#include "services/detector/core/yolo_decoder.hpp"

namespace rtd::detector {

/// The last layer of a detection head, a 1x1 convolution, computed only where something is. The objectness is computed
/// for every cell, the other planes for the cells that pass: a few in ten thousand. That is a tenth of the network's
/// time.
class PointwiseHead {
 public:
  /// `weights` are planes x channels, row-major; planes = anchors * planes_per_anchor, objectness is the fifth of each.
  PointwiseHead(const float* weights, std::vector<float> bias, std::size_t channels, std::size_t planes_per_anchor);

  std::size_t channels() const { return channels_; }
  std::size_t planes() const { return bias_.size(); }

  /// `features` are channels x cells, `logits` planes x cells. Sets all objectness planes, and the other planes of the
  /// cells whose objectness is at least min_objectness_logit; the rest of `logits` stays as it was.
  void evaluate(const float* features, std::size_t cells, float min_objectness_logit, float* logits) const;

 private:
  void evaluate_objectness(const float* features, std::size_t cells, float* logits) const;
  void evaluate_cell(const float* features, std::size_t cells, std::size_t anchor, float* cell_logits) const;

  std::size_t channels_, planes_per_anchor_;
  std::vector<float> bias_;
  std::vector<float> weights_;  ///< anchor, channel, plane: the planes of a cell are summed side by side
};

/// The loaded network: blob in, logits of the heads out. Not thread-safe.
class YoloNetwork {
 public:
  /// Loads config.model_path and runs it once. Throws ModelError.
  explicit YoloNetwork(DetectorConfig config);
  ~YoloNetwork();

  /// Runs the network on a blob (CV_32F, 1x3xHxW, RGB / 255). The logits of cells whose objectness does not pass
  /// objectness_gate() are undefined except for the objectness. Valid until the next call.
  const std::vector<HeadLogits>& infer(const cv::Mat& blob);

  InputSize input() const { return input_; }
  /// With class names and heads filled in.
  const DetectorConfig& config() const { return config_; }

 private:
  /// One output of the network.
  struct Branch {
    std::string layer;                  ///< whose output OpenCV computes: the head's input, or the output itself
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
  struct Graph;  ///< keeps OpenCV's large header out of this one
  std::unique_ptr<Graph> graph_;
  std::vector<Branch> branches_;
  std::vector<cv::String> layer_names_;
  std::vector<cv::Mat> outputs_;
  std::vector<HeadLogits> heads_;
};

}  // namespace rtd::detector
