// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/config.hpp"

namespace rtd::detector {

void ServiceConfig::bind(service::ConfigBinder& binder) {
  binder.field("model", model, "ONNX file: a path, or a name looked for in RTD_MODEL_DIR and the user's cache");
  binder.choice("input", input, {"auto", "frame", "jpeg"},
                "raw frames of this host, JPEG images of the network, or auto: where the camera is");
  binder.field("input_width_px", input_width_px, {32, 4096}, "network input, when the file does not fix it");
  binder.field("input_height_px", input_height_px, {32, 4096}, "network input, when the file does not fix it");
  binder.field("confidence_threshold", confidence_threshold, {0.01, 1.0}, "least objectness x class score");
  binder.field("objectness_threshold", objectness_threshold, {0.0, 1.0}, "cells below are not decoded");
  binder.field("nms_iou", nms_iou, {0.0, 1.0}, "boxes of a class that overlap a better one by more are dropped");
  binder.field("max_detections", max_detections, {1, 1000}, "the best ones are published");
  binder.field("threads", threads, {1, 64}, "CPU threads of the network");
  binder.field("workers", workers, {1, 16}, "pace asap: images worked on side by side, each with its own network");
  binder.field("max_rate_hz", max_rate_hz, {0.0, 1000.0}, "realtime pace: detect at most this often, 0 = no limit");
  binder.field("class_names", class_names,
               "names in the order of the network's classes; empty: those in the file, else COCO's");
  binder.choice("derotate", derotate, {"off", "on"},
                "on: detect on the image turned upright by the roll of slam's poses");
  binder.field("derotate_min_deg", derotate_min_deg, {0.0, 180.0}, "a smaller roll is left as it is");
  binder.field("roll_timeout_ms", roll_timeout_ms, {1, 60000}, "pace lockstep: longest wait for slam's pose before");
  binder.field("first_roll_deg", first_roll_deg, {-180.0, 180.0},
               "roll of the first image: by how much it must be turned clockwise to stand upright");
  binder.field("first_pitch_deg", first_pitch_deg, {-60.0, 60.0}, "how far the first camera looked down");
}

RollConfig roll_config(const ServiceConfig& config) {
  return {down_of_first_camera(config.first_roll_deg * kRadPerDeg, config.first_pitch_deg * kRadPerDeg),
          config.derotate_min_deg * kRadPerDeg};
}

DetectorConfig to_core(const ServiceConfig& config, const std::string& model_path) {
  DetectorConfig core;
  core.model_path = model_path;
  core.input_width_px = config.input_width_px;
  core.input_height_px = config.input_height_px;
  core.decode = {config.confidence_threshold, config.objectness_threshold, config.nms_iou, config.max_detections};
  core.threads = config.threads;
  core.class_names = config.class_names;
  return core;
}

}  // namespace rtd::detector
