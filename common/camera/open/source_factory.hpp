// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/source_uri.hpp"
#include "common/recordings/reader.hpp"

namespace rtd::camera {

/// The topics of a recording that its frames, their calibration and ground truth are not made of; none for other
/// sources. Throws SourceError.
std::vector<recordings::RecordedTopic> auxiliary_topics(const std::string& uri);

/// The recording that a source plays; null for other sources. Throws SourceError.
std::unique_ptr<recordings::Reader> recording_of(const std::string& uri);

/// Opens a source by its URI:
///   folder:FOLDER[?calibration=FILE&intrinsics=fx,fy,cx,cy&depth_factor=1000&fps=30&tolerance_ms=20&masks=1]
///   tum:FOLDER[?...]   the same
///   bag:FILE[?color=TOPIC&depth=TOPIC&info=TOPIC&depth_info=TOPIC&calibration=FILE&intrinsics=...&depth_factor=...
///     &registered=1&tolerance_ms=20]   ROS 1 bag
///   db3:FILE[?...]   the same of a rosbag2 file in sqlite3 format
///   mcap:FILE[?...]   the same of a recording of any form; frames that we recorded ourselves come first
///   synthetic:SCENE[?seed=1&frames=300&fps=30&noise=1&people=N&boxes=N&width=640&height=480]   frames=0: endless;
///   more keys, and the faults of the sensor (sensor=kinect&holes=0.2&...): services/camera/README.md
/// A running camera (ros2:, openni2:) is opened by the service
/// (services/camera/live_camera.hpp). Throws SourceError for an unknown scheme or parameter (with those known) and for
/// what the source itself refuses.
std::unique_ptr<FrameSource> make_source(const std::string& uri);

}  // namespace rtd::camera
