// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/map.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/vision/features.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/map/landmark.hpp"

namespace rtd::slam {
namespace {

/// Descriptors compared when the most typical one is chosen; the newest of a long track are enough.
constexpr std::size_t kMaxComparedDescriptors = 16;

int weight_of(const Keyframe& keyframe, std::uint32_t feature) {
  return keyframe.frame->features[feature].depth_m > 0 ? 2 : 1;
}

auto find_observation(std::vector<Observation>& observations, KeyframeId keyframe) {
  return std::lower_bound(observations.begin(), observations.end(), keyframe,
                          [](const Observation& o, KeyframeId id) { return o.keyframe < id; });
}

/// Grows by little when full: most landmarks have few observations, and doubling would keep half of their memory empty.
void insert(std::vector<Observation>& observations, std::vector<Observation>::iterator position,
            const Observation& added) {
  const std::ptrdiff_t at = position - observations.begin();
  if (observations.size() == observations.capacity())
    observations.reserve(observations.size() + 2 + observations.size() / 4);
  observations.insert(observations.begin() + at, added);
}

}  // namespace

KeyframeId Map::add_keyframe(FramePtr frame, const Eigen::Isometry3d& T_world_camera, KeyframeId parent) {
  const KeyframeId id = next_keyframe_++;
  Keyframe keyframe;
  keyframe.id = id;
  keyframe.landmarks.assign(frame->features.size(), kNoLandmark);
  keyframe.frame = std::move(frame);
  keyframe.T_world_camera = T_world_camera;
  keyframe.parent = parent;
  const Keyframe* before = keyframes_.empty() ? nullptr : &keyframes_.rbegin()->second;
  if (before != nullptr) keyframe.way_m = before->way_m;
  if (keyframe.is_origin()) {
    keyframe.map = next_map_++;
  } else {
    Keyframe& older = keyframe_at(parent);
    keyframe.map = older.map;
    older.children.push_back(id);
    if (before->map == keyframe.map)
      keyframe.way_m += (T_world_camera.translation() - before->T_world_camera.translation()).norm();
  }
  ++component_sizes_[keyframe.map];
  keyframe_index_.add(id, &keyframes_.emplace(id, std::move(keyframe)).first->second);
  return id;
}

LandmarkId Map::add_landmark(const Eigen::Vector3d& p_world, Observation observation) {
  const LandmarkId id = next_landmark_++;
  Landmark landmark;
  landmark.id = id;
  landmark.position = p_world;
  landmark.reference = landmark.first_keyframe = observation.keyframe;
  landmarks_.emplace(id, std::move(landmark));
  add_observation(id, observation);
  return id;
}

bool Map::add_observation(LandmarkId id, Observation observation) {
  Landmark& landmark = landmarks_.at(id);
  Keyframe& keyframe = keyframe_at(observation.keyframe);
  if (keyframe.landmarks[observation.feature] != kNoLandmark) return false;
  const auto position = find_observation(landmark.observations, observation.keyframe);
  if (position != landmark.observations.end() && position->keyframe == observation.keyframe) return false;
  change_covisibility(landmark, observation.keyframe, +1);
  insert(landmark.observations, position, observation);
  landmark.observation_weight += weight_of(keyframe, observation.feature);
  landmark.appearance_is_current = false;
  keyframe.landmarks[observation.feature] = id;
  return true;
}

void Map::remove_observation(LandmarkId id, KeyframeId keyframe) {
  Landmark& landmark = landmarks_.at(id);
  const auto position = find_observation(landmark.observations, keyframe);
  if (position == landmark.observations.end() || position->keyframe != keyframe) return;
  Keyframe& observer = keyframe_at(keyframe);
  observer.landmarks[position->feature] = kNoLandmark;
  landmark.observation_weight -= weight_of(observer, position->feature);
  landmark.appearance_is_current = false;
  landmark.observations.erase(position);
  change_covisibility(landmark, keyframe, -1);
  if (landmark.observations.empty()) {
    landmarks_.erase(id);
  } else if (landmark.reference == keyframe) {
    landmark.reference = landmark.observations.front().keyframe;
  }
}

void Map::remove_landmark(LandmarkId id) {
  while (const Landmark* landmark = find_landmark(id)) remove_observation(id, landmark->observations.back().keyframe);
}

void Map::replace_landmark(LandmarkId lost_id, LandmarkId kept_id) {
  if (lost_id == kept_id) return;
  const Landmark lost = landmarks_.at(lost_id);
  remove_landmark(lost_id);
  for (const Observation& observation : lost.observations) add_observation(kept_id, observation);
  Landmark& kept = landmarks_.at(kept_id);
  kept.witness = kept.witness || lost.witness;
  if (kept.carried_since_ns == 0 || (lost.carried_since_ns != 0 && lost.carried_since_ns < kept.carried_since_ns))
    kept.carried_since_ns = lost.carried_since_ns;
  kept.visible += lost.visible;
  kept.found += lost.found;
  refresh_landmark(kept_id);
}

void Map::remove_keyframe(KeyframeId id) {
  Keyframe& keyframe = keyframe_at(id);
  for (const LandmarkId landmark : std::vector<LandmarkId>(keyframe.landmarks)) {
    if (landmark != kNoLandmark) remove_observation(landmark, id);
  }
  if (keyframe.is_origin()) {
    hand_on_origin(keyframe);
  } else {
    Keyframe& parent = keyframe_at(keyframe.parent);
    removed_[id] = {keyframe.parent, parent.T_world_camera.inverse() * keyframe.T_world_camera};
    removed_order_.push_back(id);
    parent.children.erase(std::find(parent.children.begin(), parent.children.end(), id));
    for (const KeyframeId child : keyframe.children) adopt_child(keyframe.parent, child);
  }
  if (--component_sizes_[keyframe.map] == 0) component_sizes_.erase(keyframe.map);
  keyframe_index_.erase(id);
  keyframes_.erase(id);
}

void Map::hand_on_origin(const Keyframe& origin) {
  if (origin.children.empty()) return;
  const KeyframeId eldest = origin.children.front();
  keyframe_at(eldest).parent = kNoKeyframe;
  for (const KeyframeId child : origin.children)
    if (child != eldest) adopt_child(eldest, child);
}

void Map::adopt_child(KeyframeId parent, KeyframeId child) {
  keyframe_at(child).parent = parent;
  std::vector<KeyframeId>& children = keyframe_at(parent).children;
  children.insert(std::upper_bound(children.begin(), children.end(), child), child);
}

void Map::join_components(MapId joined, KeyframeId parent) {
  const MapId map = keyframe_at(parent).map;
  if (map == joined) return;
  for (auto& [id, keyframe] : keyframes_) {
    if (keyframe.map != joined) continue;
    keyframe.map = map;
    if (keyframe.is_origin()) adopt_child(parent, id);
  }
  component_sizes_[map] += component_sizes_[joined];
  component_sizes_.erase(joined);
}

std::size_t Map::keyframe_count(MapId map) const {
  const auto it = component_sizes_.find(map);
  return it == component_sizes_.end() ? 0 : it->second;
}

const Keyframe& Map::keyframe_at(KeyframeId id) const {
  if (const Keyframe* keyframe = find_keyframe(id)) return *keyframe;
  throw std::out_of_range("keyframe " + std::to_string(id) + " is not in the map");
}

Keyframe& Map::keyframe_at(KeyframeId id) {
  return const_cast<Keyframe&>(std::as_const(*this).keyframe_at(id));
}

void Map::change_covisibility(const Landmark& landmark, KeyframeId keyframe, int change) {
  auto& own = keyframe_at(keyframe).covisible;
  for (const Observation& observation : landmark.observations) {
    if (observation.keyframe == keyframe) continue;
    auto& others = keyframe_at(observation.keyframe).covisible;
    const int shared = own[observation.keyframe] += change;
    others[keyframe] = shared;
    if (shared > 0) continue;
    own.erase(observation.keyframe);
    others.erase(keyframe);
  }
}

void Map::refresh_landmark(LandmarkId id) {
  refresh_geometry(id);
  refresh_appearance(landmarks_.at(id));
}

void Map::refresh_geometry(LandmarkId id) {
  Landmark& landmark = landmarks_.at(id);
  Eigen::Vector3d direction_sum = Eigen::Vector3d::Zero();
  for (const Observation& observation : landmark.observations) {
    const Keyframe& keyframe = keyframe_at(observation.keyframe);
    direction_sum += (landmark.position - keyframe.T_world_camera.translation()).normalized();
    if (observation.keyframe != landmark.reference) continue;
    const double distance_m = (landmark.position - keyframe.T_world_camera.translation()).norm();
    landmark.max_distance_m = distance_m * kOctaveScale[keyframe.frame->features[observation.feature].octave];
    landmark.min_distance_m = landmark.max_distance_m / kOctaveScale.back();
  }
  landmark.normal = direction_sum.normalized();
}

void Map::refresh_appearance(Landmark& landmark) {
  if (landmark.appearance_is_current) return;
  landmark.appearance_is_current = true;
  std::array<const msg::Descriptor*, kMaxComparedDescriptors> descriptors{};
  std::size_t count = 0;
  double sum = 0, sum_decided = 0;
  int decided = 0;
  for (auto it = landmark.observations.rbegin(); it != landmark.observations.rend(); ++it) {
    const msg::Feature& feature = keyframe_at(it->keyframe).frame->features[it->feature];
    sum += feature.static_probability;
    if ((feature.flags & msg::kFeatureInQuestion) == 0) {
      sum_decided += feature.static_probability;
      ++decided;
    }
    if (count < descriptors.size()) descriptors[count++] = &feature.descriptor;
  }
  landmark.in_question = decided == 0;
  landmark.static_probability =
      decided > 0 ? sum_decided / decided : sum / static_cast<double>(landmark.observations.size());
  std::array<std::array<int, kMaxComparedDescriptors>, kMaxComparedDescriptors> all_distances{};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      all_distances[i][j] = all_distances[j][i] = vision::hamming_distance(*descriptors[i], *descriptors[j]);
    }
  }
  int best_median = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < count; ++i) {
    auto& distances = all_distances[i];
    const auto median = distances.begin() + static_cast<std::ptrdiff_t>((count - 1) / 2);
    std::nth_element(distances.begin(), median, distances.begin() + static_cast<std::ptrdiff_t>(count));
    if (*median < best_median) {
      best_median = *median;
      landmark.descriptor = *descriptors[i];
    }
  }
}

std::pair<KeyframeId, Eigen::Isometry3d> Map::living_ancestor(KeyframeId id) const {
  Eigen::Isometry3d T_ancestor_camera = Eigen::Isometry3d::Identity();
  for (auto it = removed_.find(id); it != removed_.end(); it = removed_.find(id)) {
    T_ancestor_camera = it->second.T_parent_camera * T_ancestor_camera;
    id = it->second.parent;
  }
  keyframe_at(id);
  return {id, T_ancestor_camera};
}

Eigen::Isometry3d Map::T_world_keyframe(KeyframeId id) const {
  const auto [ancestor, T_ancestor_camera] = living_ancestor(id);
  return keyframe_at(ancestor).T_world_camera * T_ancestor_camera;
}

void Map::forget_removed(std::size_t recent) {
  if (removed_order_.size() <= recent) return;
  const auto first_kept = removed_order_.end() - static_cast<std::ptrdiff_t>(recent);
  std::set<KeyframeId> kept(first_kept, removed_order_.end());
  for (const LoopEdge& loop : loops_) {
    for (const KeyframeId end : {loop.older, loop.newer}) {
      if (removed_.contains(end)) kept.insert(end);
    }
  }
  // What is kept may hang on what goes.
  std::map<KeyframeId, RemovedKeyframe> remaining;
  for (const KeyframeId id : kept) {
    const auto [ancestor, T_ancestor_camera] = living_ancestor(id);
    remaining[id] = {ancestor, geometry::normalized(T_ancestor_camera)};
  }
  removed_ = std::move(remaining);
  removed_order_.erase(removed_order_.begin(), first_kept);
}

MapId Map::map_of(KeyframeId id) const {
  return keyframe_at(living_ancestor(id).first).map;
}

void spread_certainty(Map& map, KeyframeId older, KeyframeId newer) {
  const Keyframe *tied = map.find_keyframe(older), *newest = map.find_keyframe(newer);
  if (tied == nullptr || newest == nullptr || older >= newer) return;
  const geometry::Matrix6d kept = tied->covariance.value_or(geometry::Matrix6d::Zero());
  const MapId component = newest->map;
  for (auto it = map.keyframes().upper_bound(older); it != map.keyframes().end(); ++it) {
    Keyframe& keyframe = *map.find_keyframe(it->first);
    if (keyframe.map != component || !keyframe.covariance) continue;
    const double way = std::min(1.0, static_cast<double>(keyframe.id - older) / static_cast<double>(newer - older));
    const geometry::Matrix6d gained = *keyframe.covariance - kept;
    if (gained.trace() > 0) keyframe.covariance = kept + (1 - way) * gained;
  }
}

std::vector<MapId> Map::maps() const {
  std::vector<MapId> maps;
  for (const auto& [map, size] : component_sizes_) maps.push_back(map);
  return maps;
}

std::vector<KeyframeId> Map::best_covisible(KeyframeId id, std::size_t count, int min_shared) const {
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [other, shared] : keyframe_at(id).covisible) {
    if (shared >= min_shared) ranked.emplace_back(-shared, other);
  }
  std::sort(ranked.begin(), ranked.end());
  if (ranked.size() > count) ranked.resize(count);
  std::vector<KeyframeId> best;
  best.reserve(ranked.size());
  for (const auto& [shared, other] : ranked) best.push_back(other);
  return best;
}

UnmeasuredDepth unmeasured_depth(const Map& map, const Landmark& landmark) {
  constexpr double kAssumed_per_m = 0.05, kSmallest_m = 1e-3;
  if (has_measured_depth(landmark)) return {};
  const Keyframe& first = *map.find_keyframe(landmark.observations.front().keyframe);
  UnmeasuredDepth unmeasured{kAssumed_per_m, first.T_world_camera.translation()};
  double baseline_m = kSmallest_m;
  for (const Observation& observation : landmark.observations) {
    const Eigen::Vector3d camera = map.find_keyframe(observation.keyframe)->T_world_camera.translation();
    baseline_m = std::max(baseline_m, (camera - unmeasured.seen_from).norm());
  }
  unmeasured.sigma_per_m = std::min(kAssumed_per_m, 1 / (first.frame->camera.fx * baseline_m));
  return unmeasured;
}

}  // namespace rtd::slam
