// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/map_view.hpp"

#include <algorithm>
#include <span>

namespace rtd::slam {
namespace {

constexpr std::size_t kKeyframesAtOnce = 500, kLandmarksAtOnce = 20'000;  // about 2 ms each
constexpr int kMinShared = 50;  ///< landmarks in common that make an edge worth drawing

std::vector<KeyframeId> edges_of(const Keyframe& keyframe) {
  std::vector<KeyframeId> older;
  for (const auto& [other, shared] : keyframe.covisible) {
    if (other > keyframe.id) break;
    if (shared >= kMinShared || other == keyframe.parent) older.push_back(other);
  }
  return older;
}

/// Up to kKeyframesAtOnce keyframes behind those that the view has; false when there are no more.
bool append_keyframes(const Map& map, MapView& view) {
  const KeyframeId last = view.keyframes.empty() ? kNoKeyframe : view.keyframes.back().id;
  auto next = last == kNoKeyframe ? map.keyframes().begin() : map.keyframes().upper_bound(last);
  for (std::size_t i = 0; i < kKeyframesAtOnce && next != map.keyframes().end(); ++i, ++next) {
    const Keyframe& keyframe = next->second;
    view.keyframes.push_back(
        {keyframe.id, keyframe.map, keyframe.frame->stamp_ns, keyframe.T_world_camera, {}, {}, edges_of(keyframe)});
  }
  return next != map.keyframes().end();
}

KeyframeView* find(MapView& view, KeyframeId id) {
  const auto found = std::ranges::lower_bound(view.keyframes, id, {}, &KeyframeView::id);
  return found == view.keyframes.end() || found->id != id ? nullptr : &*found;
}

/// Gives landmarks to their keyframes. Neighbours in `ids` mostly have the same one.
void append_landmarks(const Map& map, std::span<const LandmarkId> ids, MapView& view) {
  KeyframeId reference = kNoKeyframe;
  KeyframeView* keyframe = nullptr;
  Eigen::Isometry3d T_camera_world;
  for (const LandmarkId id : ids) {
    const Landmark* landmark = map.find_landmark(id);
    if (landmark == nullptr) continue;
    if (landmark->reference != reference) {
      reference = landmark->reference;
      const Keyframe* living = map.find_keyframe(reference);
      keyframe = living == nullptr ? nullptr : find(view, reference);
      if (keyframe != nullptr) T_camera_world = living->T_world_camera.inverse();
    }
    if (keyframe == nullptr) continue;  // came after its keyframe's portion
    keyframe->landmarks.push_back(id);
    keyframe->points_m.emplace_back((T_camera_world * landmark->position).cast<float>());
  }
}

void append_loops(const Map& map, MapView& view) {
  for (const LoopEdge& loop : map.loops()) {
    const KeyframeId older = map.living_ancestor(loop.older).first, newer = map.living_ancestor(loop.newer).first;
    if (older != newer) view.loop_edges.insert(view.loop_edges.end(), {older, newer});
  }
}

}  // namespace

MapView copy_view(const ReadMap& read) {
  MapView view;
  for (bool more = true; more;) read([&](const Map& map) { more = append_keyframes(map, view); });
  std::vector<LandmarkId> ids;
  read([&](const Map& map) {
    ids = map.landmark_ids();
    append_loops(map, view);
  });
  for (std::size_t begin = 0; begin < ids.size(); begin += kLandmarksAtOnce) {
    const auto portion = std::span(ids).subspan(begin, std::min(kLandmarksAtOnce, ids.size() - begin));
    read([&](const Map& map) { append_landmarks(map, portion, view); });
  }
  return view;
}

}  // namespace rtd::slam
