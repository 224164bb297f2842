// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/map_tool/map_export.hpp"

#include <fmt/ostream.h>

#include <algorithm>
#include <ostream>
#include <unordered_map>

namespace rtd::map_tool {

std::vector<slam::MapPoint> points_of(const slam::MapContents& contents, slam::MapId map) {
  std::unordered_map<slam::KeyframeId, slam::MapId> map_of;
  for (const slam::Keyframe& keyframe : contents.keyframes) map_of.emplace(keyframe.id, keyframe.map);
  std::vector<slam::MapPoint> points;
  for (const slam::Landmark& landmark : contents.landmarks) {
    if (map_of.at(landmark.reference) != map) continue;
    points.push_back({landmark.position.cast<float>(), static_cast<float>(landmark.static_probability)});
  }
  return points;
}

std::vector<slam::StampedPose> poses_of(const slam::MapContents& contents, slam::MapId map) {
  std::vector<slam::StampedPose> poses;
  for (const slam::Keyframe& keyframe : contents.keyframes) {
    if (keyframe.map == map) poses.push_back({keyframe.frame->stamp_ns, keyframe.T_world_camera});
  }
  std::stable_sort(poses.begin(), poses.end(), [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return poses;
}

void write_pcd(std::ostream& out, const std::vector<slam::MapPoint>& points) {
  fmt::print(out,
             "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z static_probability\nSIZE 4 4 4 4\n"
             "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA ascii\n",
             points.size());
  for (const slam::MapPoint& point : points)
    fmt::print(out, "{:.5f} {:.5f} {:.5f} {:.3f}\n", point.position.x(), point.position.y(), point.position.z(),
               point.static_probability);
}

}  // namespace rtd::map_tool
