// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/config.hpp"

#include "common/vision/motion_levels.hpp"
#include "services/filter/core/modes/mode_table.hpp"

namespace rtd::filter {

std::vector<std::string> mode_names() {
  std::vector<std::string> names;
  for (const ModeEntry& entry : all_modes()) names.emplace_back(entry.name);
  return names;
}

void ServiceConfig::bind(service::ConfigBinder& binder) {
  binder.choice("mode", mode, mode_names(), "which parts of the filter are at work");
  binder.choice("detector", detector, {"auto", "off"}, "auto: use a detector if one runs; off: never wait, never use");
  binder.field("detections_timeout_ms", detections_timeout_ms, {1, 600000},
               "asap, lockstep: longest wait for the boxes of one frame");
  binder.field("feedback_timeout_ms", feedback_timeout_ms, {1, 600000},
               "lockstep: longest wait for slam's result of the previous frame");
  binder.field("shed_load", shed_load, "realtime: do less, in steps, while poses come late; false: never");
  binder.field("map_frame", map_frame, "frame of rt/filter/movers: as slam.map_frame");
  core.bind(binder);
}

FilterConfig ServiceConfig::core_config() const {
  FilterConfig config = core;
  for (const ModeEntry& entry : all_modes()) {
    if (mode == entry.name) config.mode = entry.mode;
  }
  try {
    const vision::MotionLevels check(config.motion_levels);
  } catch (const std::invalid_argument& error) {
    throw service::ConfigError(std::string("filter.motion_levels: ") + error.what());
  }
  return config;
}

}  // namespace rtd::filter
