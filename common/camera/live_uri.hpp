// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// The topics of a camera that runs now, by their ROS names. Transforms come on /tf_static and /tf.
struct LiveTopics {
  std::string color, depth, info, depth_info;
};

/// The parameters of `ros2:COLOR,DEPTH[,INFO][?calibration=FILE&depth_info=TOPIC&registered=1&tolerance_ms=20]`.
struct LiveOptions {
  LiveTopics topics;
  std::string calibration_file;  ///< replaces the driver's calibration and depth unit
  bool registered = false;       ///< depth is registered to colour, whatever it looks like
  std::int64_t tolerance_ns = kPairingToleranceNs;
};

/// Whether the URI is that of a running camera: ROS 2 topics or a device.
bool is_live(const std::string& uri);

/// Throws SourceError when the URI of a running camera is malformed; opens nothing.
void check_live_uri(const std::string& uri);

/// Topics and parameters of such a URI; INFO is `camera_info` next to COLOR when not named, depth_info that next to
/// DEPTH. Throws SourceError.
LiveOptions parse_live_options(const std::string& uri);

}  // namespace rtd::camera
