// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping/mapping_steps.hpp"

#include <algorithm>

#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/optimize/bundle_adjustment.hpp"

namespace rtd::slam {
namespace {

/// A BundleProblem with the ids behind its indices.
struct LocalProblem {
  BundleProblem bundle;
  std::vector<KeyframeId> keyframes;  ///< per camera
  std::vector<LandmarkId> landmarks;  ///< per point
  std::map<KeyframeId, std::uint32_t> camera_index;

  void add_keyframe(const Keyframe& keyframe, bool fixed) {
    camera_index[keyframe.id] = static_cast<std::uint32_t>(keyframes.size());
    keyframes.push_back(keyframe.id);
    bundle.cameras.push_back({keyframe.T_world_camera, fixed});
  }
};

/// Whether a landmark is seen by one keyframe only: it ties that keyframe to nothing and simply moves with it.
bool rides_along(const Landmark& landmark) {
  return landmark.observations.size() == 1;
}

/// Landmarks that tie the keyframes together, by id.
std::vector<LandmarkId> landmarks_between(const Map& map, const std::vector<KeyframeId>& keyframes) {
  std::vector<LandmarkId> landmarks = landmarks_of(map, keyframes);
  std::erase_if(landmarks, [&](LandmarkId id) { return rides_along(*map.find_landmark(id)); });
  return landmarks;
}

/// Keyframes outside the window that see most of its landmarks.
std::vector<KeyframeId> select_fixed(const Map& map, const std::vector<KeyframeId>& window,
                                     const std::vector<LandmarkId>& landmarks, std::size_t count) {
  std::map<KeyframeId, int> shared;
  for (const LandmarkId landmark : landmarks) {
    for (const Observation& observation : map.find_landmark(landmark)->observations) ++shared[observation.keyframe];
  }
  for (const KeyframeId id : window) shared.erase(id);
  std::vector<std::pair<int, KeyframeId>> ranked;
  ranked.reserve(shared.size());
  for (const auto& [id, number] : shared) ranked.emplace_back(-number, id);
  std::sort(ranked.begin(), ranked.end());
  if (ranked.size() > count) ranked.resize(count);
  std::vector<KeyframeId> fixed;
  fixed.reserve(ranked.size());
  for (const auto& [number, id] : ranked) fixed.push_back(id);
  return fixed;
}

void add_observations(const Map& map, LocalProblem& problem) {
  for (std::uint32_t point = 0; point < problem.landmarks.size(); ++point) {
    const Landmark& landmark = *map.find_landmark(problem.landmarks[point]);
    problem.bundle.points.push_back(landmark.position);
    for (const Observation& observation : landmark.observations) {
      const auto camera = problem.camera_index.find(observation.keyframe);
      if (camera == problem.camera_index.end()) continue;
      problem.bundle.observations.push_back(bundle_observation(*map.find_keyframe(observation.keyframe),
                                                               observation.feature, landmark, camera->second, point));
    }
  }
}

LocalProblem build(const Map& map, KeyframeId newest, const MapperConfig& config) {
  LocalProblem problem;
  std::vector<KeyframeId> window = map.best_covisible(newest, static_cast<std::size_t>(config.ba_keyframes - 1));
  window.insert(window.begin(), newest);
  problem.landmarks = landmarks_between(map, window);
  std::vector<KeyframeId> fixed =
      select_fixed(map, window, problem.landmarks, static_cast<std::size_t>(config.ba_fixed_keyframes));
  const KeyframeId oldest = *std::min_element(window.begin(), window.end());
  for (const KeyframeId id : window) {
    // The first keyframe of a map is its origin; a window that nothing else holds is held by its oldest.
    const Keyframe& keyframe = *map.find_keyframe(id);
    problem.add_keyframe(keyframe, keyframe.is_origin() || (fixed.empty() && id == oldest));
  }
  for (const KeyframeId id : fixed) problem.add_keyframe(*map.find_keyframe(id), true);
  problem.bundle.camera = map.find_keyframe(newest)->frame->camera;
  set_intrinsics(map, problem.keyframes, problem.bundle);
  add_observations(map, problem);
  return problem;
}

void move_keyframe(Map& map, KeyframeId id, const Eigen::Isometry3d& T_world_camera) {
  Keyframe& keyframe = *map.find_keyframe(id);
  const Eigen::Isometry3d T_after_before = T_world_camera * keyframe.T_world_camera.inverse();
  keyframe.T_world_camera = T_world_camera;
  for (const LandmarkId landmark_id : keyframe.landmarks) {
    Landmark* landmark = landmark_id == kNoLandmark ? nullptr : map.find_landmark(landmark_id);
    if (landmark == nullptr || !rides_along(*landmark)) continue;
    landmark->position = T_after_before * landmark->position;
    map.refresh_geometry(landmark_id);
  }
}

std::vector<KeyframeId> apply(Map& map, const LocalProblem& problem) {
  std::vector<KeyframeId> moved;
  for (std::size_t i = 0; i < problem.keyframes.size(); ++i) {
    const BundleCamera& camera = problem.bundle.cameras[i];
    if (camera.fixed) continue;
    move_keyframe(map, problem.keyframes[i], camera.T_world_camera);
    moved.push_back(problem.keyframes[i]);
  }
  for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
    map.find_landmark(problem.landmarks[i])->position = problem.bundle.points[i];
  }
  for (const BundleObservation& observation : problem.bundle.observations) {
    const LandmarkId landmark = problem.landmarks[observation.point];
    if (observation.inlier || map.find_landmark(landmark) == nullptr) continue;
    map.remove_observation(landmark, problem.keyframes[observation.camera]);
    // A landmark that only a single view is left to see, after another one contradicted it, is not kept.
    const Landmark* rest = map.find_landmark(landmark);
    if (rest != nullptr && rest->observation_weight <= 2) map.remove_landmark(landmark);
  }
  for (const LandmarkId landmark : problem.landmarks) {
    if (map.find_landmark(landmark) != nullptr) map.refresh_geometry(landmark);
  }
  return moved;
}

}  // namespace

void set_intrinsics(const Map& map, const std::vector<KeyframeId>& keyframes, BundleProblem& bundle) {
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    vision::RgbdProjection intrinsics = map.find_keyframe(keyframes[i])->frame->camera;
    intrinsics.disparity_px_m = bundle.camera.disparity_px_m;
    bundle.cameras[i].intrinsics = intrinsics;
  }
}

BundleObservation bundle_observation(const Keyframe& keyframe, std::uint32_t feature, const Landmark& landmark,
                                     std::uint32_t camera, std::uint32_t point) {
  const Frame& frame = *keyframe.frame;
  const msg::Feature& f = frame.features[feature];
  const double weight = static_weight(f, landmark.static_probability, landmark.in_question) *
                        (landmark.witness ? 1.0 : keyframe.probation_weight);
  return {camera, point, frame.measurement(feature), sigma_px(f.octave), std::max(weight, 1e-3), true};
}

std::vector<KeyframeId> adjust_local_map(Map& map, KeyframeId newest, const MapperConfig& config,
                                         const std::function<bool()>& interrupted) {
  LocalProblem problem = build(map, newest, config);
  BundleOptions options;
  options.iterations_robust = config.ba_iterations_robust;
  options.iterations = config.ba_iterations;
  options.interrupted = interrupted;
  adjust_bundle(problem.bundle, options);
  return apply(map, problem);
}

}  // namespace rtd::slam
