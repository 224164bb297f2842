// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

namespace rtd::detector {

/// Size of one anchor in pixels of the network's input.
struct Anchor {
  float width_px = 0, height_px = 0;
};

/// One output of the network: cells of stride_px, three anchors a cell.
struct HeadLayout {
  int stride_px = 0;
  std::array<Anchor, 3> anchors{};
};

/// When a cell of the network's output becomes a detection.
struct DecodeConfig {
  double confidence_threshold = 0.25;
  double objectness_threshold = 0.1;
  double nms_iou = 0.45;
  int max_detections = 100;

  void bind(auto& binder) {
    binder.field("confidence_threshold", confidence_threshold, {0.01, 1.0}, "least objectness x class score");
    binder.field("objectness_threshold", objectness_threshold, {0.0, 1.0}, "cells below are not decoded");
    binder.field("nms_iou", nms_iou, {0.0, 1.0}, "boxes of a class that overlap a better one by more are dropped");
    binder.field("max_detections", max_detections, {1, 1000}, "the best ones are published");
  }
};

/// Everything the detector needs.
struct DetectorConfig {
  std::string model_path;  ///< ONNX file of a known family (services/detector/README.md)
  int input_width_px = 640, input_height_px = 480;
  DecodeConfig decode;
  int threads = 1;
  std::string engine = "auto";  ///< parse_engine()
  std::string onnxruntime;      ///< library that "auto" may load; empty: none
  std::vector<std::string> class_names;
  std::vector<HeadLayout> heads;  ///< YOLOv5; empty: those in the file, else as published

  void bind(auto& binder) {
    binder.field("input_width_px", input_width_px, {32, 4096}, "network input, when the file does not fix it");
    binder.field("input_height_px", input_height_px, {32, 4096}, "network input, when the file does not fix it");
    decode.bind(binder);
    binder.field("threads", threads, {1, 64}, "CPU threads of the network (OpenCV's, for the whole process)");
    binder.field("class_names", class_names,
                 "names in the order of the network's classes; empty: those in the file, else COCO's");
  }
};

/// The 80 COCO class names in the order of the network's class outputs; person is 0.
const std::vector<std::string>& coco_class_names();

/// The network cannot be used; what() names the file, the cause and the fix.
class ModelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rtd::detector
