// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/vision/detection.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/core/onnx_file.hpp"

namespace rtd::detector {

/// The network that turns person boxes into pixels, and how it is used.
struct MaskConfig {
  std::string model_path;       ///< ONNX file: N x 3 x H x W, RGB, 0 to 1, to N x 1 x H x W, probability of a person
  std::string engine = "auto";  ///< parse_engine(), as the detector's
  std::string onnxruntime;      ///< library that "auto" may load; empty: none
  int threads = 1;              ///< CPU threads of ONNX Runtime; OpenCV's are set by the Detector
  int masks_per_frame = 4;
  double threshold = 0.5;
  double growth = 0.1;

  void bind(auto& binder) {
    binder.field("masks_per_frame", masks_per_frame, {1, 16}, "people that get a mask, the largest first");
    binder.field("mask_threshold", threshold, {0.05, 0.95}, "least probability of a person's pixel");
    binder.field("mask_growth", growth, {0.0, 0.5}, "by which share of its size a box grows on each side");
  }
};

/// The person boxes of a frame as pixels. Each box, grown and clipped to the image, is stretched to the input of a
/// network for people; its probabilities, brought back to the image, belong to the box. Not thread-safe.
class PersonSegmenter {
 public:
  /// Loads the network and runs it once. Throws ModelError when the file is missing, broken or of another kind;
  /// EngineError when the engine or its device is not there.
  explicit PersonSegmenter(MaskConfig config);
  /// With an engine that is there already. Throws ModelError when its output is no mask of `input`.
  PersonSegmenter(MaskConfig config, std::unique_ptr<Engine> engine, InputSize input);

  /// Masks of the `masks_per_frame` largest people ("person") among the first vision::kMaxMasks detections. Where
  /// people overlap, a place belongs to the one with the higher probability. An image without people has no masks.
  /// `color_bgr`: 8-bit BGR; empty: no masks.
  /// `fresh_at_most`: so many masks are computed, first of who has none yet, then of who waits longest; others are
  /// those of the last call, moved and scaled with their box. From masks_per_frame on the result depends on this frame
  /// alone. Throws std::invalid_argument for another pixel type; EngineError and cv::Exception when the engine fails.
  vision::PersonMasks segment(const cv::Mat& color_bgr, const std::vector<vision::Detection>& detections,
                              int fresh_at_most);

  /// What computes the network, for people.
  const std::string& device() const { return engine_->device(); }
  const MaskConfig& config() const { return config_; }

 private:
  struct Mask {
    std::size_t detection = 0;  ///< whose it is
    cv::Rect2d box_px;
    cv::Matx23d to_input = cv::Matx23d::zeros();  ///< maps pixels of the image to those of `probability`
    cv::Mat probability;                          ///< CV_32F; empty: there is none yet
    int age = 0;                                  ///< calls since it was computed
  };

  std::vector<Mask> largest_people(const std::vector<vision::Detection>& detections) const;
  void take_from_last(Mask& mask) const;
  void compute(Mask& mask, const cv::Mat& color_bgr);
  void label(const Mask& mask, vision::PersonMasks& masks, std::vector<float>& best) const;

  MaskConfig config_;
  std::unique_ptr<Engine> engine_;
  InputSize input_;
  cv::Mat crop_, blob_;
  std::vector<Mask> last_;
};

}  // namespace rtd::detector
