// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/local_map.hpp"

#include <algorithm>

namespace rtd::slam {
namespace {

/// The window of keyframes: centre, its covisible ones, then the best neighbours of those.
std::vector<KeyframeId> select_window(const Map& map, KeyframeId centre, std::size_t max_keyframes) {
  constexpr std::size_t kNeighboursOfNeighbour = 10;
  std::vector<KeyframeId> window{centre};
  const auto add = [&](KeyframeId id) {
    if (window.size() < max_keyframes && std::find(window.begin(), window.end(), id) == window.end()) {
      window.push_back(id);
    }
  };
  for (const KeyframeId id : map.best_covisible(centre, max_keyframes, 1)) add(id);
  const std::size_t direct = window.size();
  for (std::size_t i = 0; i < direct; ++i) {
    for (const KeyframeId id : map.best_covisible(window[i], kNeighboursOfNeighbour)) add(id);
  }
  return window;
}

LocalKeyframe copy_keyframe(const Keyframe& keyframe) {
  return {keyframe.id, keyframe.frame, keyframe.T_world_camera, keyframe.landmarks, keyframe.covariance};
}

LocalLandmark copy_landmark(const Map& map, const Landmark& landmark) {
  return {landmark.id,
          landmark.position,
          landmark.normal,
          landmark.min_distance_m,
          landmark.max_distance_m,
          landmark.static_probability,
          landmark.in_question,
          landmark.witness,
          unmeasured_depth(map, landmark),
          landmark.observation_weight,
          landmark.descriptor,
          0,
          0};
}

}  // namespace

const LocalLandmark* LocalMap::find_landmark(LandmarkId id) const {
  const auto it = std::lower_bound(landmarks.begin(), landmarks.end(), id,
                                   [](const LocalLandmark& landmark, LandmarkId key) { return landmark.id < key; });
  return it == landmarks.end() || it->id != id ? nullptr : &*it;
}

const LocalKeyframe* LocalMap::find_keyframe(KeyframeId id) const {
  const auto it = std::find_if(keyframes.begin(), keyframes.end(), [id](const auto& k) { return k.id == id; });
  return it == keyframes.end() ? nullptr : &*it;
}

int LocalMap::confirmed_landmarks(const LocalKeyframe& keyframe) const {
  const int min_weight = component_keyframes <= 2 ? 2 : 3;
  return static_cast<int>(std::count_if(keyframe.landmarks.begin(), keyframe.landmarks.end(), [&](LandmarkId id) {
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : find_landmark(id);
    return landmark != nullptr && landmark->observation_weight >= min_weight;
  }));
}

LocalMapPtr make_local_map(const Map& map, KeyframeId centre, std::uint64_t version, std::size_t max_keyframes) {
  auto local = std::make_shared<LocalMap>();
  local->version = version;
  local->map = map.find_keyframe(centre)->map;
  local->components = map.component_count();
  local->component_keyframes = map.keyframe_count(local->map);
  local->map_keyframes = map.keyframes().size();
  local->map_landmarks = map.landmark_count();
  std::vector<std::pair<LandmarkId, std::uint32_t>> seen;  // landmark, index of a keyframe that sees it
  for (const KeyframeId id : select_window(map, centre, max_keyframes)) {
    const auto index = static_cast<std::uint32_t>(local->keyframes.size());
    local->keyframes.push_back(copy_keyframe(*map.find_keyframe(id)));
    for (const LandmarkId landmark : local->keyframes.back().landmarks) {
      if (landmark != kNoLandmark) seen.emplace_back(landmark, index);
    }
  }
  std::sort(seen.begin(), seen.end());
  local->observers.reserve(seen.size());
  for (const auto& [id, keyframe_index] : seen) {
    if (local->landmarks.empty() || local->landmarks.back().id != id) {
      local->landmarks.push_back(copy_landmark(map, *map.find_landmark(id)));
      local->landmarks.back().first_observer = static_cast<std::uint32_t>(local->observers.size());
    }
    local->observers.push_back(keyframe_index);
    ++local->landmarks.back().observers;
  }
  return local;
}

}  // namespace rtd::slam
