// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/msg/ros.hpp"
#include "common/vision/detection.hpp"

namespace rtd::detector {

/// The optical frame of the colour camera, in which boxes are given (docs/frames.md).
inline constexpr const char* kCameraFrame = "camera_color_optical_frame";

/// vision_msgs: box centre and size in px, class_id = class name, header.stamp = stamp of the image.
msg::Detection2DArray to_message(const std::vector<vision::Detection>& detections, std::int64_t stamp_ns);

}  // namespace rtd::detector
