// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/msg/stamps.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"

#include <algorithm>

namespace rtd::slam {
namespace {

/// Seen by three other keyframes in an octave that is at most one coarser.
bool seen_by_others(const Map& map, const Landmark& landmark, KeyframeId keyframe, int octave) {
  constexpr int kOthers = 3;
  int others = 0;
  for (const Observation& observation : landmark.observations) {
    if (observation.keyframe == keyframe) continue;
    const msg::Feature& feature = map.find_keyframe(observation.keyframe)->frame->features[observation.feature];
    if (feature.octave <= octave + 1 && ++others == kOthers) return true;
  }
  return false;
}

}  // namespace

void RecentLandmarks::add(const std::vector<LandmarkId>& landmarks) {
  landmarks_.insert(landmarks_.end(), landmarks.begin(), landmarks.end());
}

int RecentLandmarks::cull(Map& map, KeyframeId newest, double min_found_ratio) {
  constexpr KeyframeId kConfirmAfter = 2, kProbation = 3;
  constexpr int kMinWeight = 3;
  int removed = 0;
  std::vector<LandmarkId> remaining;
  for (const LandmarkId id : landmarks_) {
    const Landmark* landmark = map.find_landmark(id);
    if (landmark == nullptr) continue;
    const KeyframeId age = newest - landmark->first_keyframe;
    const bool rarely_found = landmark->found < min_found_ratio * landmark->visible;
    const bool unconfirmed = age >= kConfirmAfter && landmark->observation_weight <= kMinWeight;
    if (rarely_found || unconfirmed) {
      map.remove_landmark(id);
      ++removed;
    } else if (age < kProbation) {
      remaining.push_back(id);
    }
  }
  landmarks_ = std::move(remaining);
  return removed;
}

bool is_redundant_keyframe(const Map& map, KeyframeId id, std::int64_t now_ns, const MapperConfig& config) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  if (keyframe.is_origin()) return false;
  const bool old = msg::minus_s(now_ns, keyframe.frame->stamp_ns) > config.old_after_s;
  const auto landmarks = std::count_if(keyframe.landmarks.begin(), keyframe.landmarks.end(),
                                       [](LandmarkId l) { return l != kNoLandmark; });
  const double enough = (old ? config.old_redundant_ratio : config.redundant_ratio) * static_cast<double>(landmarks);
  // Most keyframes are not redundant, which shows before all landmarks are checked.
  auto seen = static_cast<double>(landmarks);
  for (std::size_t i = 0; i < keyframe.landmarks.size() && seen > enough; ++i) {
    if (keyframe.landmarks[i] == kNoLandmark) continue;
    if (!seen_by_others(map, *map.find_landmark(keyframe.landmarks[i]), id, keyframe.frame->features[i].octave)) --seen;
  }
  return seen > enough;
}

}  // namespace rtd::slam
