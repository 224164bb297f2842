// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/core/onnx_file.hpp"
#include "services/detector/core/yolo_decoder.hpp"

namespace rtd::detector {

/// The loaded network: blob in, logits of the heads out. Not thread-safe.
class YoloNetwork {
 public:
  /// Loads config.model_path into config.engine and runs it once. Throws ModelError, EngineError.
  explicit YoloNetwork(DetectorConfig config);

  /// Runs the network on a blob (CV_32F, Nx3xHxW, RGB / 255); N > 1 needs free_batch(). The logits of the first image:
  /// those of cells whose objectness does not pass objectness_gate() are undefined except for the objectness. Valid
  /// until the next call.
  const std::vector<HeadLogits>& infer(const cv::Mat& blob);
  /// Of another image of the last infer(), 0 to N - 1.
  const std::vector<HeadLogits>& heads_of(int image);
  /// Whether it takes several images at once.
  bool free_batch() const { return free_batch_; }

  InputSize input() const { return input_; }
  /// What computes it, for people.
  const std::string& device() const { return engine_->device(); }
  /// With class names and heads filled in.
  const DetectorConfig& config() const { return config_; }

 private:
  void load();
  void complete_config(const OnnxFile& file);
  void assign_layouts(const std::vector<RawHead>& raw);
  int planes_per_anchor() const { return static_cast<int>(5 + config_.class_names.size()); }

  DetectorConfig config_;
  InputSize input_;
  bool free_batch_ = false;
  std::unique_ptr<Engine> engine_;
  const std::vector<RawHead>* raw_ = nullptr;  ///< the engine's, of the last infer()
  std::vector<HeadLayout> layouts_;            ///< of the engine's outputs
  std::vector<HeadLogits> heads_;
};

}  // namespace rtd::detector
