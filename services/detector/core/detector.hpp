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
#include "services/detector/core/decoder.hpp"
#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/core/network_input.hpp"
#include "services/detector/core/onnx_file.hpp"

namespace rtd::detector {

/// The loaded network with its decoder: blob in, boxes in pixels of the input out. Not thread-safe.
class Network {
 public:
  /// Loads config.model_path into config.engine and runs it once. The decoder is the one that the file's metadata names
  /// (`rtd.decoder`), else the one that its outputs' shapes fit. Throws ModelError when the file is missing, broken, or
  /// of no known kind; EngineError when the engine or its device is not there.
  explicit Network(DetectorConfig config);

  /// Runs the network on a blob (CV_32F, Nx3xHxW, pixels()); N > 1 needs free_batch(). The result is valid until the
  /// next call.
  const std::vector<RawOutput>& infer(const cv::Mat& blob);
  /// The boxes of an image of the last infer(), 0 to N - 1, whose scores pass. Not yet suppressed.
  std::vector<Candidate> candidates(int image) const;

  /// Whether it takes several images at once.
  bool free_batch() const { return free_batch_; }
  InputSize input_size() const { return input_; }
  const PixelFormat& pixels() const { return family_->pixels; }
  /// The family that it belongs to, for people: "YOLOX".
  std::string family() const { return family_->title; }
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
  std::string wanted_decoder_;  ///< by the file; empty: any
  std::unique_ptr<Engine> engine_;
  const DecoderFamily* family_ = nullptr;
  Decoder decoder_;
  const std::vector<RawOutput>* outputs_ = nullptr;  ///< the engine's, of the last infer()
};

/// A network of one of the families (decoders/decoder.hpp) on one of the engines (engine.hpp), for images. Not
/// thread-safe; one instance per thread.
class Detector : public Network {
 public:
  using Network::Network;

  /// Objects of one image, best score first; boxes in pixels of the image, clipped to it. 8-bit BGR, BGRA or grey of
  /// any size; an empty image has no objects. Throws std::invalid_argument for another pixel type.
  std::vector<vision::Detection> detect(const cv::Mat& color_bgr);

  /// The boxes of several images at once, in their order; the same as detect() of each. More than one image needs a
  /// network whose batch is free: throws std::invalid_argument that names the tool which frees it.
  std::vector<std::vector<vision::Detection>> detect_batch(std::span<const cv::Mat> images);

 private:
  std::vector<vision::Detection> boxes_of(int image, const Letterbox& letterbox, cv::Size frame) const;

  cv::Mat batch_;
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

/// A detector that continues with the CPU when the engine asked for is not there, and computes one image after the
/// other when its network takes no batch. Not thread-safe.
class EngineGuard {
 public:
  /// Runs a first batch of each size up to `batch`, so that later ones are as fast as the others; on the CPU, where
  /// nothing is compiled for a size, only the largest. Throws ModelError; EngineError only for an engine whose name is
  /// wrong.
  explicit EngineGuard(DetectorConfig config, int batch = 1);

  std::vector<vision::Detection> detect(const cv::Mat& color_bgr) { return detector_->detect(color_bgr); }
  /// The boxes of each image, in the order of the images.
  std::vector<std::vector<vision::Detection>> detect_batch(std::span<const cv::Mat> images);

  const Detector& detector() const { return *detector_; }
  /// What computes the network and why that is not what was asked for, for people.
  std::string device() const;
  /// Why the CPU is used in place of the engine asked for; empty while it is not.
  const std::string& fallback() const { return fallback_; }
  /// Why images are computed one by one; empty while they are not.
  const std::string& no_batch() const { return no_batch_; }

 private:
  /// What `use` needs of the detector; with the CPU from now on when the engine fails.
  void guarded(const std::function<void()>& use);
  void try_batches(int most);

  DetectorConfig on_cpu_;
  std::unique_ptr<Detector> detector_;
  std::string fallback_, no_batch_;
};

}  // namespace rtd::detector
