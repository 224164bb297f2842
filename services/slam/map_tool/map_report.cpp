// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/map_tool/map_report.hpp"

#include <fmt/ostream.h>

#include <algorithm>
#include <map>
#include <ostream>
#include <unordered_map>

#include "services/slam/core/store/map_format.hpp"

namespace rtd::map_tool {
namespace {

using Parts = std::map<slam::MapId, MapPart>;
using KeyframesByTime = std::map<slam::MapId, std::vector<const slam::Keyframe*>>;

bool same_camera(const slam::Frame& a, const slam::Frame& b) {
  const vision::RgbdProjection &p = a.camera, &q = b.camera;
  return p.fx == q.fx && p.fy == q.fy && p.cx == q.cx && p.cy == q.cy && a.width_px == b.width_px &&
         a.height_px == b.height_px;
}

void add_camera(std::vector<slam::FramePtr>& cameras, const slam::FramePtr& frame) {
  const auto known = [&](const slam::FramePtr& camera) { return same_camera(*camera, *frame); };
  if (std::none_of(cameras.rbegin(), cameras.rend(), known)) cameras.push_back(frame);
}

KeyframesByTime by_time(const std::vector<slam::Keyframe>& keyframes) {
  KeyframesByTime sorted;
  for (const slam::Keyframe& keyframe : keyframes) sorted[keyframe.map].push_back(&keyframe);
  for (auto& [map, list] : sorted) {
    std::stable_sort(list.begin(), list.end(),
                     [](const auto* a, const auto* b) { return a->frame->stamp_ns < b->frame->stamp_ns; });
  }
  return sorted;
}

MapPart describe(slam::MapId id, const std::vector<const slam::Keyframe*>& keyframes) {
  MapPart part;
  part.id = id;
  part.keyframes = keyframes.size();
  part.first_stamp_ns = keyframes.front()->frame->stamp_ns;
  part.last_stamp_ns = keyframes.back()->frame->stamp_ns;
  for (std::size_t i = 1; i < keyframes.size(); ++i)
    part.path_m += (keyframes[i]->T_world_camera.translation() - keyframes[i - 1]->T_world_camera.translation()).norm();
  return part;
}

/// A landmark belongs to the map of the keyframe that its scale is measured from.
void add_landmarks(const slam::MapContents& contents, Parts& parts) {
  for (const slam::Landmark& landmark : contents.landmarks) {
    const auto reference =
        std::lower_bound(contents.keyframes.begin(), contents.keyframes.end(), landmark.reference,
                         [](const slam::Keyframe& keyframe, slam::KeyframeId id) { return keyframe.id < id; });
    MapPart& part = parts[reference->map];
    ++part.landmarks;
    part.extent_m.extend(landmark.position);
  }
}

}  // namespace

MapReport report_on(const slam::MapContents& contents, std::uint64_t file_bytes) {
  MapReport report;
  report.bytes = file_bytes;
  report.version = slam::map_format::kVersion;
  report.keyframes = contents.keyframes.size();
  report.landmarks = contents.landmarks.size();
  report.removed_keyframes = contents.removed.size();
  for (const slam::Landmark& landmark : contents.landmarks) report.observations += landmark.observations.size();
  for (const slam::Keyframe& keyframe : contents.keyframes) {
    report.features += keyframe.landmarks.size();
    add_camera(report.cameras, keyframe.frame);
  }
  Parts parts;
  for (const auto& [id, keyframes] : by_time(contents.keyframes)) parts[id] = describe(id, keyframes);
  add_landmarks(contents, parts);
  for (const auto& [id, part] : parts) report.maps.push_back(part);
  return report;
}

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
