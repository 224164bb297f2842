// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "services/launcher/doctor/doctor_command.hpp"

namespace rtd::launcher {

void describe_cameras(const std::vector<camera::FoundCamera>& cameras, Findings& findings) {
  using camera::Stream;
  for (const camera::FoundCamera& found : cameras) {
    const std::string name = fmt::format("camera: --source {} ({})", found.uri, found.name);
    const std::string modes = fmt::format("colour {}; depth {}", list_modes(found.modes, Stream::kColor),
                                          list_modes(found.modes, Stream::kDepth));
    if (found.problem.empty()) {
      findings.push_back({Verdict::kOk, name + ": " + modes});
    } else if (found.modes.empty()) {
      findings.push_back({Verdict::kWarn, name + ": " + found.problem});
    } else {
      findings.push_back({Verdict::kOk, name + ": not usable alone, " + found.problem + "; " + modes});
    }
  }
  if (cameras.empty()) {
    findings.push_back({Verdict::kOk, "cameras: none is plugged in; this build supports " +
                                          camera::supported_devices() + ", realsense-dds and ROS 2 topics"});
  }
}

}  // namespace rtd::launcher
