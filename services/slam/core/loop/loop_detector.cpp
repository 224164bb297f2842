// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/loop_detector.hpp"

#include <algorithm>
#include <set>

#include "common/geometry/se3.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"
#include "services/slam/core/tracking/tracker.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kPlaceKeyframes = 20;  ///< candidate and its neighbours: what one can see from about there

/// Landmarks found over those that should be visible; some of these are hidden by nearer things.
double found_share(const LocalMapTracking& tracking) {
  return tracking.visible.empty()
             ? 0
             : static_cast<double>(tracking.guess.inliers) / static_cast<double>(tracking.visible.size());
}

std::vector<KeyframeId> with_neighbours(const Map& map, KeyframeId keyframe, int count) {
  std::vector<KeyframeId> keyframes = map.best_covisible(keyframe, static_cast<std::size_t>(count));
  keyframes.push_back(keyframe);
  return keyframes;
}

/// What the meeting found: the keyframe's features are the place's landmarks.
int join_met(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting) {
  int joined = 0;
  for (std::uint32_t feature = 0; feature < meeting.landmarks.size(); ++feature) {
    const LandmarkId old = meeting.landmarks[feature];
    if (old == kNoLandmark || map.find_landmark(old) == nullptr) continue;
    const LandmarkId present = map.find_keyframe(keyframe)->landmarks[feature];
    if (present == old) continue;
    if (present != kNoLandmark) {
      map.replace_landmark(present, old);
    } else if (map.add_observation(old, {keyframe, feature})) {
      map.refresh_landmark(old);
    }
    ++joined;
  }
  return joined;
}

constexpr int kMinShared = 15;  ///< landmarks in common that make neighbours

/// The keyframe, its neighbours and theirs: likeness among them is expected.
std::set<KeyframeId> neighbourhood(const Map& map, KeyframeId keyframe) {
  constexpr std::size_t kAll = 1000;
  std::set<KeyframeId> near{keyframe};
  const std::vector<KeyframeId> neighbours = map.best_covisible(keyframe, kAll, kMinShared);
  near.insert(neighbours.begin(), neighbours.end());
  for (const KeyframeId neighbour : neighbours) {
    for (const KeyframeId second : map.best_covisible(neighbour, kAll, kMinShared)) near.insert(second);
  }
  return near;
}

/// How alike the keyframe and its worst neighbour are: a place that is the same looks at least so alike.
float least_similarity(const Map& map, const KeyframeDatabase& places, KeyframeId keyframe) {
  constexpr std::size_t kNeighbours = 10;
  const BagOfWords& own = *places.find(keyframe);
  float least = 1;
  for (const KeyframeId neighbour : map.best_covisible(keyframe, kNeighbours, kMinShared)) {
    const BagOfWords* bag = places.find(neighbour);
    if (bag != nullptr) least = std::min(least, similarity(own, *bag));
  }
  return least;
}

/// The correction that a meeting implies: T_world_new = T_new_old T_world_old for the keyframe and what is relative to
/// it.
Eigen::Isometry3d correction(const Keyframe& keyframe, const PlaceMeeting& meeting) {
  return meeting.T_world_camera * keyframe.T_world_camera.inverse();
}

PlaceMeeting meeting_of(const LocalMap& place, const LocalMapTracking& tracking) {
  const PoseGuess& guess = tracking.guess;
  return {vote_reference(place, guess.landmarks),
          guess.T_world_camera,
          guess.covariance,
          guess.landmarks,
          guess.inliers,
          found_share(tracking)};
}

std::int64_t no_clock() {
  return 0;
}

}  // namespace

std::optional<PlaceMeeting> meet_place(const Map& map, const Frame& frame, KeyframeId candidate,
                                       const SlamConfig& config) {
  const LocalMapPtr place = make_local_map(map, candidate, 0, kPlaceKeyframes);
  const auto tracking = track_place(frame, *place, {config, no_clock});
  if (!tracking || !tracking->guess.success || tracking->guess.inliers < config.loop.min_inliers) return std::nullopt;
  const PlaceMeeting meeting = meeting_of(*place, *tracking);
  if (meeting.found_share < config.loop.min_found_share) return std::nullopt;
  return meeting;
}

std::optional<PlaceMeeting> look_again(const Map& map, const Frame& frame, KeyframeId candidate,
                                       const Eigen::Isometry3d& T_world_camera, const SlamConfig& config) {
  constexpr double kWide = 4;  // where a decimetre takes a landmark 3 m away
  const LocalMapPtr place = make_local_map(map, candidate, 0, kPlaceKeyframes);
  SlamConfig wide = config;
  wide.tracker.local_radius_px *= kWide;
  PoseGuess start;
  start.T_world_camera = T_world_camera;
  const auto tracking = track_place_from(frame, *place, start, {wide, no_clock});
  if (!tracking || !tracking->guess.success) return std::nullopt;
  return meeting_of(*place, *tracking);
}

bool agree(const Eigen::Isometry3d& T_new_old, const Eigen::Isometry3d& other_T_new_old,
           const Eigen::Isometry3d& T_old_camera, const LoopConfig& config) {
  const Eigen::Isometry3d T = (T_new_old * T_old_camera).inverse() * other_T_new_old * T_old_camera;
  return T.translation().norm() <= config.agreement_m && geometry::rotation_angle_rad(T) <= config.agreement_rad;
}

bool drift_explains(const Eigen::Isometry3d& T_old_new, double way_m, const LoopConfig& config) {
  return T_old_new.translation().norm() <= config.max_offset_m + config.max_drift_ratio * way_m &&
         geometry::rotation_angle_rad(T_old_new) <= config.max_offset_rad + config.max_drift_rad_m * way_m;
}

int fuse_place(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting, int neighbours) {
  const std::vector<KeyframeId> here = with_neighbours(map, keyframe, neighbours);
  const std::vector<LandmarkId> there = landmarks_of(map, with_neighbours(map, meeting.place, neighbours));
  int joined = join_met(map, keyframe, meeting);
  for (const KeyframeId id : here) joined += fuse_into(map, id, there);
  for (const LandmarkId id : landmarks_of(map, here)) map.refresh_landmark(id);
  return joined;
}

std::optional<Loop> LoopDetector::detect(const Map& map, const KeyframeDatabase& places, KeyframeId newest) {
  const std::optional<PlaceMeeting> meeting = meet(map, places, newest);
  if (!meeting) {
    if (hypothesis_ && ++hypothesis_->misses > config_.loop.max_misses) hypothesis_.reset();
    return std::nullopt;
  }
  const bool confirmed = hypothesis_ && agrees(map, newest, *meeting);
  if (hypothesis_ && !confirmed) ++counters_.contradictory;
  const int confirmations = confirmed ? hypothesis_->confirmations + 1 : 1;
  hypothesis_ = Hypothesis{newest, meeting->place, correction(*map.find_keyframe(newest), *meeting), confirmations, 0};
  if (confirmations < config_.loop.confirmations) return std::nullopt;
  hypothesis_.reset();
  return Loop{newest, *meeting};
}

std::optional<PlaceMeeting> LoopDetector::meet(const Map& map, const KeyframeDatabase& places, KeyframeId newest) {
  const BagOfWords* bag = places.find(newest);
  if (bag == nullptr) return std::nullopt;
  const std::set<KeyframeId> near = neighbourhood(map, newest);
  PlaceQuery query;
  query.admitted = [&](KeyframeId id) { return !near.contains(id); };
  query.min_score = static_cast<float>(config_.loop.min_similarity) * least_similarity(map, places, newest);
  query.max_candidates = static_cast<std::size_t>(config_.loop.max_candidates);
  for (const PlaceCandidate& candidate : find_places(places, map, *bag, query)) {
    ++counters_.candidates;
    auto meeting = meet_place(map, *map.find_keyframe(newest)->frame, candidate.keyframe, config_);
    if (!meeting) continue;
    ++counters_.met;
    if (plausible(map, newest, *meeting)) return meeting;
    ++counters_.implausible;
  }
  return std::nullopt;
}

/// Between two maps nothing is known.
bool LoopDetector::plausible(const Map& map, KeyframeId newest, const PlaceMeeting& meeting) const {
  const Keyframe& keyframe = *map.find_keyframe(newest);
  const Keyframe& place = *map.find_keyframe(meeting.place);
  if (place.map != keyframe.map) return true;
  const double way_m = keyframe.way_m - place.way_m;
  return drift_explains(keyframe.T_world_camera.inverse() * meeting.T_world_camera, way_m, config_.loop);
}

/// Both keyframes imply the same correction of the newest one's pose, and of the same map.
bool LoopDetector::agrees(const Map& map, KeyframeId newest, const PlaceMeeting& meeting) const {
  const Keyframe* place_before = map.find_keyframe(hypothesis_->place);
  const Keyframe* keyframe_before = map.find_keyframe(hypothesis_->keyframe);
  const Keyframe& keyframe = *map.find_keyframe(newest);
  if (place_before != nullptr && place_before->map != map.find_keyframe(meeting.place)->map) return false;
  if (keyframe_before != nullptr && keyframe_before->map != keyframe.map) return false;
  return agree(correction(keyframe, meeting), hypothesis_->T_new_old, keyframe.T_world_camera, config_.loop);
}

}  // namespace rtd::slam
