// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/online_trajectory.hpp"

#include <fmt/format.h>

#include <iterator>

namespace rtd::launcher {

std::string online_trajectory_text(const std::vector<eval::FrameRecord>& frames) {
  std::string text;
  for (const eval::FrameRecord& frame : frames) {
    if (!msg::is_measured_in_map(frame.tracking)) continue;
    const auto& [t, q] = frame.tracking.T_world_camera;
    fmt::format_to(std::back_inserter(text), "{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                   static_cast<double>(frame.tracking.stamp_ns) * 1e-9, t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
  }
  return text;
}

}  // namespace rtd::launcher
