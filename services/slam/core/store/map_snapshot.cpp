// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/store/map_snapshot.hpp"

#include <algorithm>

#include "services/slam/core/store/field_io.hpp"
#include "services/slam/core/store/soundness.hpp"

namespace rtd::slam {
namespace {

using map_format::FieldWriter;
using map_format::StoredCamera;

/// Index of the camera of a frame, added when it is new. Nearly always all frames have one camera.
std::uint16_t find_camera(std::vector<StoredCamera>& cameras, const Frame& frame) {
  const auto same = [&](const StoredCamera& camera) {
    const vision::RgbdProjection &a = camera.projection, &b = frame.camera;
    return a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy && a.disparity_px_m == b.disparity_px_m &&
           camera.width_px == frame.width_px && camera.height_px == frame.height_px;
  };
  const auto found = std::find_if(cameras.rbegin(), cameras.rend(), same);
  if (found != cameras.rend()) return static_cast<std::uint16_t>(cameras.rend() - found - 1);
  if (cameras.size() == map_format::kMaxCameras) throw std::length_error("map file: more than 65535 cameras");
  cameras.push_back({frame.camera, frame.width_px, frame.height_px});
  return static_cast<std::uint16_t>(cameras.size() - 1);
}

void copy_landmarks(const Map& map, MapSnapshot& snapshot) {
  snapshot.landmarks.reserve(map.landmark_count() * map_format::kLandmarkBytes);
  snapshot.landmark_ids.reserve(map.landmark_count());
  FieldWriter write(snapshot.landmarks);
  for (const LandmarkId id : map.landmark_ids()) {
    const Landmark& l = *map.find_landmark(id);
    if (!map_format::is_sound(l)) continue;
    snapshot.landmark_ids.push_back(id);
    write(l.id, l.position, l.normal, l.min_distance_m, l.max_distance_m, l.static_probability, l.log_odds,
          l.descriptor, l.reference, l.first_keyframe, l.visible, l.found);
  }
}

void copy_keyframes(const Map& map, MapSnapshot& snapshot) {
  snapshot.keyframes.reserve(map.keyframes().size());
  for (const auto& [id, keyframe] : map.keyframes()) {
    for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (keyframe.landmarks[i] != kNoLandmark)
        snapshot.observations.push_back({keyframe.landmarks[i], static_cast<std::uint16_t>(i)});
    }
    snapshot.keyframes.push_back({keyframe.frame, keyframe.T_world_camera, id, keyframe.parent, keyframe.map,
                                  find_camera(snapshot.head.cameras, *keyframe.frame), snapshot.observations.size()});
  }
}

void copy_removed(const Map& map, MapSnapshot& snapshot) {
  snapshot.removed.reserve(map.removed_keyframes().size() * map_format::kRemovedBytes);
  FieldWriter write(snapshot.removed);
  for (const auto& [id, removed] : map.removed_keyframes()) write(id, removed.parent, removed.T_parent_camera);
}

}  // namespace

MapSnapshot take_snapshot(const Map& map) {
  MapSnapshot snapshot;
  copy_landmarks(map, snapshot);
  copy_keyframes(map, snapshot);
  copy_removed(map, snapshot);
  snapshot.head.keyframes = static_cast<std::uint32_t>(snapshot.keyframes.size());
  snapshot.head.landmarks = static_cast<std::uint32_t>(snapshot.landmark_ids.size());
  snapshot.head.removed = static_cast<std::uint32_t>(map.removed_keyframes().size());
  snapshot.head.next_keyframe = map.next_keyframe();
  snapshot.head.next_landmark = map.next_landmark();
  snapshot.head.next_map = map.next_map();
  snapshot.head.probability_rule = map.probability_rule();
  return snapshot;
}

}  // namespace rtd::slam
