// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/geometry/camera_model.hpp"
#include "common/msg/ros.hpp"

namespace rtd::camera {

inline constexpr const char* kCameraFrame = "camera_color_optical_frame";  ///< docs/frames.md

/// The camera_info message of a camera, ROS conventions.
msg::CameraInfo to_camera_info(const geometry::CameraModel& camera, std::int64_t stamp_ns);

/// The camera that a CameraInfo describes: K and D of the raw image, or P for a rectified one ("image_rect" in the
/// colour topic's name). Throws SourceError naming `origin`: not calibrated, distortion model other than plumb_bob, not
/// finite.
geometry::CameraModel to_camera_model(const msg::CameraInfo& info, const std::string& color_topic,
                                      const std::string& origin);

}  // namespace rtd::camera
