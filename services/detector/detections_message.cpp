// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/detections_message.hpp"

namespace rtd::detector {

msg::Detection2DArray to_message(const std::vector<vision::Detection>& detections, std::int64_t stamp_ns) {
  msg::Detection2DArray message;
  message.header = {msg::to_time(stamp_ns), kCameraFrame};
  for (const vision::Detection& detection : detections) {
    msg::ObjectHypothesisWithPose result;
    result.hypothesis = {detection.class_name, detection.score};
    msg::Detection2D box;
    box.header = message.header;
    box.results = {result};
    box.bbox.center.position = {detection.x_px + 0.5 * detection.width_px, detection.y_px + 0.5 * detection.height_px};
    box.bbox.size_x = detection.width_px;
    box.bbox.size_y = detection.height_px;
    message.detections.push_back(box);
  }
  return message;
}

}  // namespace rtd::detector
