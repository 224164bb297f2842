// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// "scheme:path?key=value&key=value".
struct SourceUri {
  std::string text, scheme, path;
  std::map<std::string, std::string> parameters;
};

/// Throws SourceError naming the malformed part and the form expected.
SourceUri parse_source_uri(const std::string& text);

/// Adds the scheme that a path leaves out: a folder is a TUM sequence, FILE.bag, FILE.db3 and FILE.mcap are recordings.
/// Everything else stays as it is.
std::string complete_uri(const std::string& source);

/// Opens a source by its URI:
///   tum:FOLDER[?masks=1]
///   bag:FILE[?color=TOPIC&depth=TOPIC&info=TOPIC&calibration=FILE]   ROS 1 bag
///   db3:FILE[?...]   the same of a rosbag2 file in sqlite3 format
///   mcap:FILE[?...]   the same of an MCAP file; frames that we recorded ourselves come first
///   synthetic:SCENE[?seed=1&frames=300&fps=30&noise=1&people=N&boxes=N&width=640&height=480]   frames=0: endless;
///   more keys, and the faults of the sensor (sensor=kinect&holes=0.2&...): services/camera/README.md
/// A running camera (ros2:) is opened by the service, which has a bus (services/camera/ros2_feed.hpp).
/// Throws SourceError for an unknown scheme or parameter (with those known) and for what the source itself refuses.
std::unique_ptr<FrameSource> make_source(const std::string& uri);

}  // namespace rtd::camera
