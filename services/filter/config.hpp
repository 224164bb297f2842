// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/msg/filter_modes.hpp"
#include "common/service/config.hpp"
#include "common/service/patience.hpp"
#include "services/filter/core/config/filter_config.hpp"

namespace rtd::filter {

/// Section `filter` of the configuration.
struct ServiceConfig {
  FilterConfig core;
  std::string mode = msg::kDefaultFilterMode;
  std::string detector = "auto";
  std::string person_masks = "off";
  int detections_timeout_ms = service::kEveryFramePatience.answer_ms;
  int feedback_timeout_ms = service::kEveryFramePatience.answer_ms;
  bool shed_load = true;
  std::string map_frame = "map";
  std::string imu, imu_mount;  ///< topic, ROS name; empty: none

  void bind(service::ConfigBinder& binder);
  /// `core` with the mode as its enum. and the IMU as it is mounted. Throws service::ConfigError for an unknown motion
  /// level and a mount that cannot be read.
  FilterConfig core_config() const;
};

}  // namespace rtd::filter
