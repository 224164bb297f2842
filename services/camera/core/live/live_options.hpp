// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "services/camera/core/live/live_feed.hpp"
#include "services/camera/core/tum_lists.hpp"

namespace rtd::camera {

/// What `ros2:COLOR,DEPTH[,INFO][?calibration=FILE&tolerance_ms=20]` asks for.
struct LiveOptions {
  LiveTopics topics;
  std::string calibration_file;  ///< replaces the driver's calibration and depth unit
  std::int64_t tolerance_ns = kPairingToleranceNs;
  std::int64_t open_timeout_ns = 30'000'000'000;  ///< until the first frame
  /// Told what is waited for, about once a second, and with an empty text when frames come (again).
  std::function<void(const std::string&)> on_wait = [](const std::string&) {};
};

/// Whether the URI is that of a running camera.
bool is_live(const std::string& uri);

/// Topics and parameters of such a URI; INFO is `camera_info` beside COLOR when not named. Throws SourceError.
LiveOptions parse_live_options(const std::string& uri);

}  // namespace rtd::camera
