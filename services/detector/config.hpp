// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/config.hpp"
#include "services/detector/core/camera_roll.hpp"
#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

/// Section `detector` of the configuration. Defaults come from the core's DetectorConfig.
struct ServiceConfig {
  std::string model;           ///< file name or path, see model_locator.hpp
  std::string input = "auto";  ///< "auto", "frame" or "jpeg": image_input.hpp
  int input_width_px = DetectorConfig{}.input_width_px;
  int input_height_px = DetectorConfig{}.input_height_px;
  double confidence_threshold = DecodeConfig{}.confidence_threshold;
  double objectness_threshold = DecodeConfig{}.objectness_threshold;
  double nms_iou = DecodeConfig{}.nms_iou;
  int max_detections = DecodeConfig{}.max_detections;
  int threads = DetectorConfig{}.threads;
  int workers = 2;                       ///< pace asap: images worked on side by side
  double max_rate_hz = 0;                ///< realtime pace only; 0 = as fast as it goes
  std::vector<std::string> class_names;  ///< empty: those in the model file, else COCO's 80
  std::string derotate = "off";          ///< "on": detect on the image turned upright by the tracked roll
  double derotate_min_deg = RollConfig{}.min_roll_rad / kRadPerDeg;
  int roll_timeout_ms = 2000;                      ///< pace lockstep: longest wait for the pose of the image before
  double first_roll_deg = 0, first_pitch_deg = 0;  ///< of the first camera: where gravity points

  void bind(service::ConfigBinder& binder);
};

/// Where down is for the camera's roll.
RollConfig roll_config(const ServiceConfig& config);

/// The core's configuration for the network at `model_path`.
DetectorConfig to_core(const ServiceConfig& config, const std::string& model_path);

}  // namespace rtd::detector
