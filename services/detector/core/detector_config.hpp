// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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
  double confidence_threshold = 0.25;  ///< objectness x class score, [0, 1]
  double objectness_threshold = 0.1;   ///< cells below are not decoded at all, [0, 1]
  double nms_iou = 0.45;               ///< a box of the same class that overlaps a better one by more is dropped
  int max_detections = 100;            ///< the best ones are kept
};

/// Strides and anchors of YOLOv5 and YOLOv5-Lite as published.
std::vector<HeadLayout> default_heads();

/// Everything the detector needs.
struct DetectorConfig {
  std::string model_path;  ///< ONNX file with one raw output per head (services/detector/README.md)
  int input_width_px = 640, input_height_px = 480;  ///< used only when the file does not fix its input size
  DecodeConfig decode;
  int threads = 1;                       ///< OpenCV threads; process-wide (cv::setNumThreads)
  std::vector<std::string> class_names;  ///< empty: those in the file, else COCO's 80
  std::vector<HeadLayout> heads;         ///< empty: those in the file, else default_heads()
};

}  // namespace rtd::detector
