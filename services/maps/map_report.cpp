// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/maps/map_report.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <map>
#include <ostream>

#include "common/service/command_line.hpp"
#include "services/slam/core/store/map_format.hpp"

namespace rtd::maps {
namespace {

using Parts = std::map<slam::MapId, MapPart>;
using KeyframesByTime = std::map<slam::MapId, std::vector<const slam::Keyframe*>>;

void add_camera(std::vector<slam::FramePtr>& cameras, const slam::FramePtr& frame) {
  const auto known = [&](const slam::FramePtr& camera) {
    const vision::RgbdProjection &p = camera->camera, &q = frame->camera;
    return p.fx == q.fx && p.fy == q.fy && p.cx == q.cx && p.cy == q.cy && camera->width_px == frame->width_px &&
           camera->height_px == frame->height_px;
  };
  if (std::none_of(cameras.rbegin(), cameras.rend(), known)) cameras.push_back(frame);
}

KeyframesByTime by_time(const std::vector<slam::Keyframe>& keyframes) {
  KeyframesByTime sorted;
  for (const slam::Keyframe& keyframe : keyframes) sorted[keyframe.map].push_back(&keyframe);
  for (auto& [map, list] : sorted) {
    std::ranges::stable_sort(list, {}, [](const slam::Keyframe* keyframe) { return keyframe->frame->stamp_ns; });
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
slam::MapId map_of(const slam::MapContents& contents, const slam::Landmark& landmark) {
  return std::ranges::lower_bound(contents.keyframes, landmark.reference, {}, &slam::Keyframe::id)->map;
}

void add_landmarks(const slam::MapContents& contents, Parts& parts) {
  for (const slam::Landmark& landmark : contents.landmarks) {
    MapPart& part = parts[map_of(contents, landmark)];
    ++part.landmarks;
    part.extent_m.extend(landmark.position);
  }
}

constexpr const char* kChecksums = "all right";  // a file with a wrong checksum gets no report

std::uint64_t unsigned_ns(std::int64_t time_ns) {
  return time_ns < 0 ? 0 : static_cast<std::uint64_t>(time_ns);
}

std::string row(const char* name, const std::string& text) {
  return fmt::format("{:<12} {}\n", name, text);
}

std::string camera_text(const slam::Frame& frame) {
  return fmt::format("{}x{}, fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}", frame.width_px, frame.height_px, frame.camera.fx,
                     frame.camera.fy, frame.camera.cx, frame.camera.cy);
}

std::string part_rows(const MapPart& part) {
  std::string text = row(fmt::format("map {}", part.id).c_str(),
                         fmt::format("{} keyframes, {} landmarks", part.keyframes, part.landmarks));
  text += row("  time", fmt::format("{} for {}", service::time_text(unsigned_ns(part.first_stamp_ns)),
                                    service::seconds_text(unsigned_ns(part.last_stamp_ns - part.first_stamp_ns))));
  text += row("  path", fmt::format("{:.2f} m", part.path_m));
  if (part.extent_m.isEmpty()) return text;
  const Eigen::Vector3d size = part.extent_m.sizes();
  return text + row("  extent", fmt::format("{:.2f} x {:.2f} x {:.2f} m", size.x(), size.y(), size.z()));
}

nlohmann::ordered_json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::ordered_json part_json(const MapPart& part) {
  nlohmann::ordered_json json = {{"id", part.id},
                                 {"keyframes", part.keyframes},
                                 {"landmarks", part.landmarks},
                                 {"first_stamp_ns", part.first_stamp_ns},
                                 {"last_stamp_ns", part.last_stamp_ns},
                                 {"path_m", part.path_m}};
  if (!part.extent_m.isEmpty())
    json["extent_m"] = {{"min", vector_json(part.extent_m.min())}, {"max", vector_json(part.extent_m.max())}};
  return json;
}

}  // namespace

MapReport report_on(const slam::MapContents& contents, std::uint64_t file_bytes) {
  MapReport report;
  report.bytes = file_bytes;
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
  report.loops = contents.loops.size();
  return report;
}

std::vector<slam::MapPoint> points_of(const slam::MapContents& contents, slam::MapId map) {
  std::vector<slam::MapPoint> points;
  for (const slam::Landmark& landmark : contents.landmarks) {
    if (map_of(contents, landmark) != map) continue;
    points.push_back({landmark.position.cast<float>(), static_cast<float>(landmark.static_probability)});
  }
  return points;
}

occupancy::Volume voxels_of(const slam::MapContents& contents, slam::MapId map) {
  occupancy::Volume volume;
  const auto cell_at = [&volume](const Eigen::Vector3d& p) {
    return Eigen::Vector3i((p / volume.cell_m).array().floor().cast<int>());
  };
  for (const slam::Landmark& landmark : contents.landmarks) {
    if (map_of(contents, landmark) != map || landmark.static_probability < 0.5) continue;
    for (const slam::Observation& observation : landmark.observations) {
      const auto keyframe = std::ranges::lower_bound(contents.keyframes, observation.keyframe, {}, &slam::Keyframe::id);
      const Eigen::Vector3d from = keyframe->T_world_camera.translation(), way = landmark.position - from;
      const int steps = static_cast<int>(std::min(2 * way.norm() / volume.cell_m, 1e4));
      for (int i = 0; i + 2 < steps; ++i)
        volume.cells.set(cell_at(from + (i + 0.5) / steps * way), occupancy::Space::kFree);
    }
  }
  for (const slam::Landmark& landmark : contents.landmarks) {
    if (map_of(contents, landmark) == map && landmark.static_probability >= 0.5)
      volume.cells.set(cell_at(landmark.position), occupancy::Space::kOccupied);
  }
  return volume;
}

std::vector<slam::StampedPose> poses_of(const slam::MapContents& contents, slam::MapId map) {
  std::vector<slam::StampedPose> poses;
  for (const slam::Keyframe& keyframe : contents.keyframes) {
    if (keyframe.map == map) poses.push_back({keyframe.frame->stamp_ns, keyframe.T_world_camera});
  }
  std::ranges::stable_sort(poses, {}, &slam::StampedPose::stamp_ns);
  return poses;
}

std::string to_text(const MapReport& report, const std::string& name) {
  std::string text = row("file", fmt::format("{}, {}", name, service::bytes_text(report.bytes)));
  text += row("version", fmt::format("{}, checksums {}", slam::map_format::kVersion, kChecksums));
  text += row("keyframes", fmt::format("{} with {} features; {} removed", report.keyframes, report.features,
                                       report.removed_keyframes));
  text += row("landmarks", fmt::format("{} seen {} times", report.landmarks, report.observations));
  text += row("loops", fmt::format("{}", report.loops));
  for (const slam::FramePtr& camera : report.cameras) text += row("camera", camera_text(*camera));
  for (const MapPart& part : report.maps) text += part_rows(part);
  return text;
}

nlohmann::ordered_json to_json(const MapReport& report, const std::string& name) {
  nlohmann::ordered_json json = {{"file", name},
                                 {"bytes", report.bytes},
                                 {"version", slam::map_format::kVersion},
                                 {"checksums", kChecksums},
                                 {"keyframes", report.keyframes},
                                 {"features", report.features},
                                 {"removed_keyframes", report.removed_keyframes},
                                 {"landmarks", report.landmarks},
                                 {"observations", report.observations},
                                 {"loops", report.loops},
                                 {"cameras", nlohmann::ordered_json::array()},
                                 {"maps", nlohmann::ordered_json::array()}};
  for (const slam::FramePtr& camera : report.cameras) {
    const vision::RgbdProjection& p = camera->camera;
    json["cameras"].push_back({{"width", camera->width_px},
                               {"height", camera->height_px},
                               {"fx", p.fx},
                               {"fy", p.fy},
                               {"cx", p.cx},
                               {"cy", p.cy}});
  }
  for (const MapPart& part : report.maps) json["maps"].push_back(part_json(part));
  return json;
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

}  // namespace rtd::maps
