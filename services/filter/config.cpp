// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/config.hpp"

#include "common/service/mount.hpp"
#include "common/service/run_settings.hpp"
#include "common/vision/motion_levels.hpp"

namespace rtd::filter {

void ServiceConfig::bind(service::ConfigBinder& binder) {
  service::bind_filter_mode(binder, mode);
  service::bind_filter_detector(binder, detector);
  service::bind_person_masks(binder, person_masks);
  binder.field("detections_timeout_ms", detections_timeout_ms, {1, 600000},
               "asap, lockstep: longest wait for a living detector's boxes of one frame");
  binder.field("feedback_timeout_ms", feedback_timeout_ms, {1, 600000},
               "lockstep: longest wait for a living slam's result of the previous frame");
  binder.field("shed_load", shed_load, "realtime: do less, in steps, while poses come late; false: never");
  binder.field("map_frame", map_frame, "frame of rt/filter/movers: as slam.map_frame");
  binder.field("imu.topic", imu,
               "topic of an IMU next to the camera, sensor_msgs/Imu: its gyroscope says how the camera turns; rtd run "
               "sets it by --imu; empty: none");
  binder.field("imu.mount", imu_mount, "as slam.imu.mount: how the IMU is turned in the camera's optical frame");
  core.bind(binder);
}

FilterConfig ServiceConfig::core_config() const {
  FilterConfig config = core;
  if (const auto* const known = msg::find_filter_mode(mode)) config.mode = known->mode;
  if (!imu.empty() && (imu.size() < 2 || !imu.starts_with('/')))
    throw service::ConfigError("filter.imu.topic=" + imu + ": a ROS topic begins with a slash, e.g. /" + imu);
  if (!imu_mount.empty()) config.gyroscope.R_camera_imu = service::parse_mount(imu_mount, "filter.imu.mount").linear();
  try {
    const vision::MotionLevels check(config.motion_levels);
  } catch (const std::invalid_argument& error) {
    throw service::ConfigError(std::string("filter.motion_levels: ") + error.what());
  }
  return config;
}

}  // namespace rtd::filter
