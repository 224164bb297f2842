// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/vision/detection.hpp"
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

/// A network of one of the families (decoders/decoder.hpp) on one of the engines (engine.hpp). Not thread-safe; one
/// instance per thread.
class Detector {
 public:
  /// Loads the network and runs it once, so that the first detect() is as fast as the others.
  /// Throws ModelError when the file is missing, broken, or of no known kind; EngineError when the
  /// engine or its device is not there.
  explicit Detector(DetectorConfig config);

  /// Objects of one image, best score first; boxes in pixels of the image, clipped to it. 8-bit BGR, BGRA or grey of
  /// any size; an empty image has no objects. Throws std::invalid_argument for another pixel type.
  std::vector<vision::Detection> detect(const cv::Mat& color_bgr);

  /// The boxes of several images at once, in their order; the same as detect() of each. More than one image needs a
  /// network whose batch is free: throws std::invalid_argument that names the tool which frees it.
  std::vector<std::vector<vision::Detection>> detect_batch(std::span<const cv::Mat> images);

  InputSize input_size() const { return network_->input(); }
  /// The family of the network, for people: "YOLOX".
  const std::string& family() const { return network_->family(); }
  /// What computes the network, for people.
  const std::string& device() const { return network_->device(); }
  /// The configuration in force, with class names and heads filled in.
  const DetectorConfig& config() const { return network_->config(); }

 private:
  using BoxInFrame = std::function<cv::Rect2f(const Candidate&)>;
  std::vector<vision::Detection> boxes_of(int image, const BoxInFrame& box_of) const;

  std::unique_ptr<Network> network_;
  cv::Mat blob_, batch_;
};

/// How far the boxes of two engines may differ.
struct AgreementLimits {
  double box_px = 0.5, score = 1e-3;
};

/// Why two engines do not agree on an image: a box that only one of them has, or whose place or score differs. Empty
/// when they agree. Boxes within `limits.score` of the confidence threshold may be missing from one.
std::string disagreement(const std::vector<vision::Detection>& expected, const std::vector<vision::Detection>& actual,
                         double confidence_threshold, const AgreementLimits& limits = {});

/// On how many images two engines agree.
struct AgreementCount {
  std::size_t images = 0, agreeing = 0;
  std::string first_difference;  ///< of the first image on which they do not agree

  /// Counts one image with what disagreement() says about it.
  void add(const std::string& difference);
};

/// A detector that continues with the CPU when the engine asked for is not there. Not thread-safe.
class EngineGuard {
 public:
  /// Throws ModelError; EngineError only for an engine whose name is wrong.
  explicit EngineGuard(DetectorConfig config);

  std::vector<vision::Detection> detect(const cv::Mat& color_bgr) { return detector_->detect(color_bgr); }
  std::vector<std::vector<vision::Detection>> detect_batch(std::span<const cv::Mat> images) {
    return detector_->detect_batch(images);
  }

  /// Runs a batch that compiles what its size needs. Throws std::invalid_argument as Detector::detect_batch() does;
  /// falls back when the engine fails.
  void warm_up(std::span<const cv::Mat> images);

  const Detector& detector() const { return *detector_; }
  /// Why the CPU is used in place of the engine asked for; empty while it is not.
  const std::string& fallback() const { return fallback_; }

 private:
  void fall_back(const std::string& cause);

  DetectorConfig on_cpu_;
  std::unique_ptr<Detector> detector_;
  std::string fallback_;
};

}  // namespace rtd::detector
