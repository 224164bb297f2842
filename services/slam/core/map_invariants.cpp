// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "services/slam/core/map.hpp"

namespace rtd::slam {
namespace {

std::string check_landmark(const Map& map, const Landmark& landmark) {
  const std::string name = "landmark " + std::to_string(landmark.id);
  if (landmark.observations.empty()) return name + " has no observation";
  KeyframeId previous = kNoKeyframe;
  int weight = 0;
  for (const Observation& observation : landmark.observations) {
    if (previous != kNoKeyframe && observation.keyframe <= previous) return name + " has unordered observations";
    previous = observation.keyframe;
    const Keyframe* keyframe = map.find_keyframe(observation.keyframe);
    if (keyframe == nullptr) return name + " is seen by a keyframe that is gone";
    if (keyframe->landmarks[observation.feature] != landmark.id) return name + " is unknown to its keyframe";
    weight += keyframe->frame->features[observation.feature].depth_m > 0 ? 2 : 1;
  }
  return weight == landmark.observation_weight ? std::string{} : name + " miscounts its observations";
}

std::string check_keyframe(const Map& map, const Keyframe& keyframe) {
  const std::string name = "keyframe " + std::to_string(keyframe.id);
  if (keyframe.parent != kNoKeyframe && keyframe.parent >= keyframe.id) return name + " has a younger parent";
  if (keyframe.parent != kNoKeyframe && map.find_keyframe(keyframe.parent) == nullptr) return name + " lost its parent";
  std::map<KeyframeId, int> shared;
  for (std::size_t feature = 0; feature < keyframe.landmarks.size(); ++feature) {
    if (keyframe.landmarks[feature] == kNoLandmark) continue;
    const Landmark* landmark = map.find_landmark(keyframe.landmarks[feature]);
    if (landmark == nullptr) return name + " sees a landmark that is gone";
    bool known = false;
    for (const Observation& observation : landmark->observations) {
      if (observation.keyframe == keyframe.id) {
        known = observation.feature == feature;
      } else {
        ++shared[observation.keyframe];
      }
    }
    if (!known) return name + " is unknown to its landmark " + std::to_string(landmark->id);
  }
  return shared == keyframe.covisible ? std::string{} : name + " miscounts its covisible keyframes";
}

}  // namespace

std::string Map::check_invariants() const {
  for (const LandmarkId id : landmark_ids()) {
    if (std::string error = check_landmark(*this, *find_landmark(id)); !error.empty()) return error;
  }
  for (const auto& [id, keyframe] : keyframes_) {
    if (std::string error = check_keyframe(*this, keyframe); !error.empty()) return error;
  }
  return {};
}

}  // namespace rtd::slam
