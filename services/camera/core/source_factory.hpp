// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// Opens a source by its URI:
///   tum:FOLDER[?masks=1]
///   bag:FILE[?color=TOPIC&depth=TOPIC&info=TOPIC&calibration=FILE]   ROS 1 bag
///   mcap:FILE[?...]   the same of an MCAP file; frames that we recorded ourselves come first
///   synthetic:SCENE[?seed=1&frames=300&fps=30&noise=1&people=N&boxes=N&width=640&height=480]   frames=0: endless
/// A running camera (ros2:) is opened by the service, which has a bus (services/camera/ros2_source.hpp).
/// Throws SourceError for an unknown scheme or parameter (with those known) and for what the source itself refuses.
std::unique_ptr<FrameSource> make_source(const std::string& uri);

}  // namespace rtd::camera
