// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "services/detector/core/decoders/decoder.hpp"
#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/core/onnx_file.hpp"

namespace rtd::detector {

/// The loaded network with its decoder: blob in, boxes in pixels of the input out. Not thread-safe.
class Network {
 public:
  /// Loads config.model_path into config.engine and runs it once. The decoder is the one that the file's metadata names
  /// (`rtd.decoder`), else the one that its outputs' shapes fit. Throws ModelError, EngineError.
  explicit Network(DetectorConfig config);

  /// Runs the network on a blob (CV_32F, Nx3xHxW, pixels()); N > 1 needs free_batch(). The result is valid until the
  /// next call.
  const std::vector<RawOutput>& infer(const cv::Mat& blob);
  /// The boxes of an image of the last infer(), 0 to N - 1, whose scores pass. Not yet suppressed.
  std::vector<Candidate> candidates(int image) const;

  /// Whether it takes several images at once.
  bool free_batch() const { return free_batch_; }
  InputSize input() const { return input_; }
  PixelFormat pixels() const { return decoder_->pixels(); }
  /// The family that it belongs to, for people: "YOLOX".
  const std::string& family() const { return family_; }
  /// What computes it, for people.
  const std::string& device() const { return engine_->device(); }
  /// With class names and heads filled in.
  const DetectorConfig& config() const { return config_; }

 private:
  void load();
  void complete_config(const OnnxFile& file);
  void choose_decoder();

  DetectorConfig config_;
  InputSize input_;
  bool free_batch_ = false;
  std::string family_;
  std::string wanted_decoder_;  ///< by the file; empty: any
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<Decoder> decoder_;
  const std::vector<RawOutput>* outputs_ = nullptr;  ///< the engine's, of the last infer()
};

}  // namespace rtd::detector
