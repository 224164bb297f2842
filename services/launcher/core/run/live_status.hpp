// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/msg/tracking.hpp"

namespace rtd::launcher {

/// What the live line shows, as of the newest tracked frame.
struct LiveStatus {
  std::uint64_t frames = 0;    ///< frames of the source so far
  std::uint64_t total = 0;     ///< length of the source, 0 = unknown or endless
  std::string camera_message;  ///< what the camera says of itself, e.g. whom it waits for
  bool tracking = false;       ///< false until the first TrackingResult: the fields below are empty
  msg::TrackingState state = msg::TrackingState::kInitializing;
  double frames_per_s = 0;  ///< over the last second or so
  std::uint32_t inliers = 0;
  std::uint32_t dynamic_points = 0;
  std::uint64_t dropped = 0;  ///< on the way from the camera to the pose
  double latency_ms = 0;      ///< camera -> pose, median of the last frames
};

/// "frame 123/210  29.8 fps  ok  inliers 213  dynamic 87  dropped 0  latency 31 ms", always short enough for 100
/// columns.
std::string format_live_status(const LiveStatus& status);

}  // namespace rtd::launcher
