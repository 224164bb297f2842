// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/camera/recording/recording.hpp"

namespace rtd::camera {

/// "scheme:path?key=value&key=value".
struct SourceUri {
  std::string text, scheme, path;
  std::map<std::string, std::string> parameters;
};

/// Throws SourceError naming the malformed part and the form expected.
SourceUri parse_source_uri(const std::string& text);

/// The topics of a recording that its frames, their calibration and ground truth are not made of; none for other
/// sources. Throws SourceError.
std::vector<RecordedTopic> auxiliary_topics(const std::string& uri);

/// The recording that a source plays; null for other sources. Throws SourceError.
std::unique_ptr<recordings::Reader> recording_of(const std::string& uri);

/// The value of `tolerance_ms`, ns: more than 0, at most 1000 ms. Throws SourceError naming the URI.
std::int64_t parse_tolerance_ns(const std::string& uri, const std::string& value);
/// The value of a parameter that is 0 or 1. Throws SourceError naming URI and key.
bool parse_flag(const std::string& uri, const std::string& key, const std::string& value);

/// Adds the scheme that a path, with or without ?key=value, leaves out: a folder holds frames (tum: where it has TUM's
/// lists) or a recording, FILE.bag, FILE.db3, FILE.mcap and FILE.oni are
/// recordings. Everything else stays as it is.
std::string complete_uri(const std::string& source);

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
