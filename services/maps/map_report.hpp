// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/occupancy/volume.hpp"
#include "services/slam/core/map/trajectory.hpp"
#include "services/slam/map_file.hpp"

namespace rtd::maps {

/// One map of a file: its keyframes and landmarks have one frame.
struct MapPart {
  slam::MapId id = 0;
  std::size_t keyframes = 0, landmarks = 0;
  std::int64_t first_stamp_ns = 0, last_stamp_ns = 0;  ///< of its keyframes
  double path_m = 0;                                   ///< from keyframe to keyframe by time
  Eigen::AlignedBox3d extent_m;                        ///< of its landmarks
};

/// What is in a map file.
struct MapReport {
  std::uint64_t bytes = 0;  ///< of the file
  std::size_t keyframes = 0, landmarks = 0, observations = 0, features = 0, removed_keyframes = 0, loops = 0;
  std::vector<slam::FramePtr> cameras;  ///< a frame of each camera
  std::vector<MapPart> maps;            ///< by id
};

MapReport report_on(const slam::MapContents& contents, std::uint64_t file_bytes);

/// What `rtd map info` prints.
std::string to_text(const MapReport& report, const std::string& name);
nlohmann::ordered_json to_json(const MapReport& report, const std::string& name);

/// The landmarks of one map of a file, by id.
std::vector<slam::MapPoint> points_of(const slam::MapContents& contents, slam::MapId map);
/// The poses of its keyframes, by time.
std::vector<slam::StampedPose> poses_of(const slam::MapContents& contents, slam::MapId map);

/// What landmarks show of space: they are occupied, and free is what lies between them and the keyframes that see them.
occupancy::Volume voxels_of(const slam::MapContents& contents, slam::MapId map);

/// ASCII PCD 0.7: x y z static_probability, as the Point Cloud Library reads it.
void write_pcd(std::ostream& out, const std::vector<slam::MapPoint>& points);

}  // namespace rtd::maps
