// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

#include "common/geometry/ply.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kLineLength = 256;
constexpr double kUnknownDepth_per_m = 0.02;  ///< of the inverse: a metre at 7 m

}  // namespace

void thin_out(std::vector<FrameRecord>& frames, std::size_t limit) {
  if (frames.size() < limit) return;
  const std::size_t half = frames.size() / 2;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i >= half || i % 2 == 0) frames[kept++] = frames[i];
  }
  frames.resize(kept);
}

FrameRecord* find_frame(std::vector<FrameRecord>& frames, std::uint64_t seq) {
  const auto frame =
      std::find_if(frames.rbegin(), frames.rend(), [seq](const FrameRecord& record) { return record.seq == seq; });
  return frame == frames.rend() ? nullptr : &*frame;
}

void correct_frames(std::span<const PoseCorrection> corrections, std::vector<FrameRecord>& frames) {
  for (const auto& [seq, T_claimed_smoothed] : corrections) {
    FrameRecord* const frame = find_frame(frames, seq);
    if (frame != nullptr) frame->T_reference_camera = frame->T_reference_camera * T_claimed_smoothed;
  }
}

void tie_to_living(std::vector<FrameRecord>& frames, const Map& map) {
  for (FrameRecord& frame : frames) {
    if (map.find_keyframe(frame.reference) != nullptr) continue;
    const auto [ancestor, T_ancestor_reference] = map.living_ancestor(frame.reference);
    frame.T_reference_camera = T_ancestor_reference * frame.T_reference_camera;
    frame.reference = ancestor;
  }
}

std::vector<StampedPose> compose_trajectory(const Map& map, const std::vector<FrameRecord>& frames, MapId id) {
  std::vector<StampedPose> poses;
  poses.reserve(frames.size());
  for (const FrameRecord& frame : frames) {
    if (map.map_of(frame.reference) != id) continue;
    poses.push_back({frame.stamp_ns, map.T_world_keyframe(frame.reference) * frame.T_reference_camera});
  }
  return poses;
}

std::vector<StampedPose> keyframe_trajectory(const Map& map, MapId id) {
  std::vector<StampedPose> poses;
  for (const auto& [keyframe_id, keyframe] : map.keyframes()) {
    if (keyframe.map == id) poses.push_back({keyframe.frame->stamp_ns, keyframe.T_world_camera});
  }
  return poses;
}

std::vector<MapPoint> map_points(const Map& map, MapId id) {
  std::vector<MapPoint> points;
  points.reserve(map.landmark_count());
  append_map_points(map, id, map.landmark_ids(), points);
  return points;
}

void append_map_points(const Map& map, MapId id, std::span<const LandmarkId> landmarks, std::vector<MapPoint>& points) {
  for (const LandmarkId landmark_id : landmarks) {
    const Landmark* landmark = map.find_landmark(landmark_id);
    if (landmark == nullptr || map.map_of(landmark->reference) != id) continue;
    if (unmeasured_depth(map, *landmark).sigma_per_m > kUnknownDepth_per_m) continue;
    points.push_back({landmark->position.cast<float>(), static_cast<float>(landmark->static_probability)});
  }
}

void write_ply(std::ostream& out, const std::vector<MapPoint>& points) {
  geometry::write_ply_header(out, geometry::PlyFormat::kAscii, "RTD-SLAM landmarks, world frame, metres", points.size(),
                             {{"float", "x"}, {"float", "y"}, {"float", "z"}, {"float", "static_probability"}});
  std::array<char, kLineLength> line{};
  for (const MapPoint& point : points) {
    std::snprintf(line.data(), line.size(), "%.5f %.5f %.5f %.3f\n", static_cast<double>(point.position.x()),
                  static_cast<double>(point.position.y()), static_cast<double>(point.position.z()),
                  static_cast<double>(point.static_probability));
    out << line.data();
  }
}

}  // namespace rtd::slam
