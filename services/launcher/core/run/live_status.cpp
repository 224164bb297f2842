// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/live_status.hpp"

#include <fmt/format.h>

namespace rtd::launcher {

std::string format_live_status(const LiveStatus& status) {
  const std::string count = status.total > 0 ? fmt::format("frame {}/{}", status.frames, status.total)
                                             : fmt::format("frame {}", status.frames);
  if (!status.tracking) {
    return count + "  " +
           (status.camera_message.empty() ? "waiting for the first pose" : "camera " + status.camera_message);
  }
  return fmt::format("{}  {:.1f} fps  {}  inliers {}  dynamic {}  dropped {}  latency {:.0f} ms", count,
                     status.frames_per_s, to_string(status.state), status.inliers, status.dynamic_points,
                     status.dropped, status.latency_ms);
}

}  // namespace rtd::launcher
