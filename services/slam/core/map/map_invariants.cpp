// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "services/slam/core/map/map.hpp"

namespace rtd::slam {
namespace {

std::string check_landmark(const Map& map, const Landmark& landmark) {
  const std::string name = "landmark " + std::to_string(landmark.id);
  if (landmark.observations.empty()) return name + " has no observation";
  KeyframeId previous = kNoKeyframe;
  bool seen_by_reference = false;
  int weight = 0;
  for (const Observation& observation : landmark.observations) {
    if (previous != kNoKeyframe && observation.keyframe <= previous) return name + " has unordered observations";
    previous = observation.keyframe;
    seen_by_reference = seen_by_reference || observation.keyframe == landmark.reference;
    const Keyframe* keyframe = map.find_keyframe(observation.keyframe);
    if (keyframe == nullptr) return name + " is seen by a keyframe that does not exist";
    if (keyframe->landmarks[observation.feature] != landmark.id) return name + " is unknown to its keyframe";
    weight += keyframe->frame->features[observation.feature].depth_m > 0 ? 2 : 1;
  }
  if (!seen_by_reference) return name + " is not seen by its reference";
  return weight == landmark.observation_weight ? std::string{} : name + " miscounts its observations";
}

std::string check_family(const Map& map, const Keyframe& keyframe) {
  if (!keyframe.is_origin()) {
    const Keyframe* parent = map.find_keyframe(keyframe.parent);
    if (parent == nullptr) return " lost its parent";
    if (parent->id >= keyframe.id) return " has a younger parent";
    if (parent->map != keyframe.map) return " belongs to another map than its parent";
    if (!std::binary_search(parent->children.begin(), parent->children.end(), keyframe.id)) {
      return " is unknown to its parent";
    }
  }
  for (const KeyframeId id : keyframe.children) {
    const Keyframe* child = map.find_keyframe(id);
    if (child == nullptr || child->parent != keyframe.id) return " has a child that is not its own";
  }
  return {};
}

std::string check_keyframe(const Map& map, const Keyframe& keyframe) {
  const std::string name = "keyframe " + std::to_string(keyframe.id);
  if (std::string error = check_family(map, keyframe); !error.empty()) return name + error;
  std::map<KeyframeId, int> shared;
  for (std::size_t feature = 0; feature < keyframe.landmarks.size(); ++feature) {
    if (keyframe.landmarks[feature] == kNoLandmark) continue;
    const Landmark* landmark = map.find_landmark(keyframe.landmarks[feature]);
    if (landmark == nullptr) return name + " sees a landmark that does not exist";
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
    if (find_landmark(id)->id != id) return "landmark " + std::to_string(id) + " is stored under the id of another one";
    if (std::string error = check_landmark(*this, *find_landmark(id)); !error.empty()) return error;
  }
  std::map<MapId, std::size_t> sizes;
  for (const auto& [id, keyframe] : keyframes_) {
    ++sizes[keyframe.map];
    if (find_keyframe(id) != &keyframe) return "keyframe " + std::to_string(id) + " is not in the index";
    if (std::string error = check_keyframe(*this, keyframe); !error.empty()) return error;
  }
  return sizes == component_sizes_ ? std::string{} : "keyframes of a component are miscounted";
}

}  // namespace rtd::slam
