// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// What the user asks of the modes; 0 = the device's best.
struct ModeRequest {
  int width = 0, height = 0;
  double fps = 0;
};

/// `openni2:[URI]` or `realsense-dds:[SERIAL]`, each with
/// [?calibration=FILE&tolerance_ms=20&width=640&height=480&fps=30].
struct DeviceUri {
  std::string text;
  std::string scheme;  ///< "openni2" or "realsense-dds"
  std::string device;  ///< what follows it; empty = the first that is found
  ModeRequest mode;
  std::string calibration_file;  ///< replaces the device's own calibration and depth unit
  std::int64_t tolerance_ns = 0;
  bool recorded = false;  ///< an .oni file: played by its stamps, from its first frame to its last
};

/// Whether the URI is that of a device of this host or network.
bool is_device(const std::string& uri);

/// Throws SourceError naming the parameter, its value and what is allowed.
DeviceUri parse_device_uri(const std::string& uri);

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
