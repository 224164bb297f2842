// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/vision/detection.hpp"
#include "common/vision/person_masks.hpp"
#include "services/detector/core/engine.hpp"

namespace rtd::detector {

/// The network that turns person boxes into pixels, and how it is used.
struct MaskConfig {
  std::string model_path;       ///< ONNX file of services/detector/tools/selfie_to_onnx.py
  std::string engine = "auto";  ///< parse_engine(), as the detector's
  std::string onnxruntime;      ///< library that "auto" may load; empty: none
  std::string kernel_cache;     ///< folder for what an OpenCL driver compiles; empty: none
  int threads = 1;              ///< CPU threads of ONNX Runtime; OpenCV's are set by the Detector
  int masks_per_frame = 4;
  double threshold = 0.5;
  double growth = 0.1;

  void bind(auto& binder) {
    binder.field("masks_per_frame", masks_per_frame, {1, 16}, "people that get a mask, the largest first");
    binder.field("mask_threshold", threshold, {0.05, 0.95}, "least probability of a person's pixel");
    binder.field("mask_growth", growth, {0.0, 0.5}, "by how much of its size a box grows before the network sees it");
  }
};

/// The person boxes of a frame as pixels. Each box, grown, is scaled to the input of a network for people; its
/// probabilities, brought back to the image, belong to the box. Not thread-safe; one instance per thread.
class PersonSegmenter {
 public:
  /// Loads the network and runs it once. Throws ModelError when the file is missing, broken or is of another kind;
  /// EngineError when the engine or its device is not there.
  explicit PersonSegmenter(MaskConfig config);

  /// Masks of the `masks_per_frame` largest people among the detections ("person"; those from the 256th on have none).
  /// Where people overlap, a place belongs to the one with the higher probability. 8-bit BGR; an empty image and one
  /// without people have no masks (empty()). Throws std::invalid_argument for another pixel type.
  /// `fresh_at_most`: as many masks are computed; others follow from those of the last call, moved and scaled with
  /// their box. Who has no last mask and who has waited longest comes first. With at least masks_per_frame, the
  /// result depends on this frame alone.
  vision::PersonMasks segment(const cv::Mat& color_bgr, const std::vector<vision::Detection>& detections,
                              int fresh_at_most);

  /// What computes the network, for people.
  const std::string& device() const { return engine_->device(); }
  const MaskConfig& config() const { return config_; }

 private:
  /// One person: probabilities over the grown box.
  struct Mask {
    vision::Detection person;
    cv::Rect2f area_px;   ///< that the probabilities cover; may reach beyond the image
    cv::Mat probability;  ///< CV_32F, one channel
    int age = 0;          ///< calls since it was computed
  };
  struct Place;

  MaskConfig config_;
  std::unique_ptr<Engine> engine_;
  cv::Mat blob_;
  std::vector<Mask> last_;
};

}  // namespace rtd::detector
