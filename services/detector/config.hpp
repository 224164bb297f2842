// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/detector/core/camera_roll.hpp"
#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

/// Section `detector` of the configuration.
struct ServiceConfig {
  std::string model;
  std::string input = "auto";
  DetectorConfig core;
  int workers = 2;
  double max_rate_hz = 0;
  std::string derotate = "off";
  double derotate_min_deg = RollConfig{}.min_roll_rad / kRadPerDeg;
  int roll_timeout_ms = 2000;
  double first_roll_deg = 0, first_pitch_deg = 0;

  void bind(auto& binder) {
    binder.field("model", model, "ONNX file: a path, or a name looked for in RTD_MODEL_DIR and the user's cache");
    binder.choice("input", input, {"auto", "frame", "jpeg"},
                  "raw frames of this host, JPEG images of the network, or auto: where the camera is");
    core.bind(binder);
    binder.field("workers", workers, {1, 16}, "pace asap: images worked on side by side, each with its own network");
    binder.field("max_rate_hz", max_rate_hz, {0.0, 1000.0}, "realtime pace: detect at most this often, 0 = no limit");
    binder.choice("derotate", derotate, {"off", "on"},
                  "on: detect on the image turned upright by the roll of slam's poses");
    binder.field("derotate_min_deg", derotate_min_deg, {0.0, 180.0}, "a smaller roll is left as it is");
    binder.field("roll_timeout_ms", roll_timeout_ms, {1, 60000},
                 "pace lockstep: longest wait for slam's pose of the image before");
    binder.field("first_roll_deg", first_roll_deg, {-180.0, 180.0},
                 "roll of the first image: by how much it must be turned clockwise to stand upright");
    binder.field("first_pitch_deg", first_pitch_deg, {-60.0, 60.0}, "how far the first camera looked down");
  }
};

}  // namespace rtd::detector
