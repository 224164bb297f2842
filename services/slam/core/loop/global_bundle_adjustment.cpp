// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/global_bundle_adjustment.hpp"

#include <algorithm>
#include <utility>

#include "services/slam/core/loop/essential_graph.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"

namespace rtd::slam {
namespace {

void add_observations(const Map& map, const Landmark& landmark, std::uint32_t point, GlobalProblem& problem) {
  for (const Observation& observation : landmark.observations) {
    const Keyframe& keyframe = *map.find_keyframe(observation.keyframe);
    const auto camera = std::lower_bound(problem.keyframes.begin(), problem.keyframes.end(), keyframe.id);
    if (camera == problem.keyframes.end() || *camera != keyframe.id) continue;
    const auto index = static_cast<std::uint32_t>(camera - problem.keyframes.begin());
    problem.bundle.observations.push_back(bundle_observation(keyframe, observation.feature, landmark, index, point));
  }
}

/// New poses of all keyframes of the component: adjusted ones, and newer ones relative to their parents.
KeyframePoses follow_parents(const Map& map, const GlobalProblem& problem) {
  KeyframePoses poses;
  for (std::size_t i = 0; i < problem.keyframes.size(); ++i) {
    if (map.find_keyframe(problem.keyframes[i]) == nullptr) continue;
    poses[problem.keyframes[i]] = problem.bundle.cameras[i].T_world_camera;
  }
  for (const auto& [id, keyframe] : map.keyframes()) {  // ascending: a parent is older and so done before
    if (keyframe.map != problem.component || keyframe.is_origin() || poses.contains(id)) continue;
    const auto parent = poses.find(keyframe.parent);
    if (parent == poses.end()) continue;
    const Eigen::Isometry3d T_parent_camera =
        map.find_keyframe(keyframe.parent)->T_world_camera.inverse() * keyframe.T_world_camera;
    poses[id] = geometry::normalized(parent->second * T_parent_camera);
  }
  return poses;
}

}  // namespace

GlobalProblem copy_global_problem(const Map& map, MapId component) {
  GlobalProblem problem;
  problem.component = component;
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (keyframe.map != component) continue;
    problem.keyframes.push_back(id);
    problem.bundle.cameras.push_back({keyframe.T_world_camera, keyframe.is_origin()});
    problem.bundle.camera = keyframe.frame->camera;
  }
  set_intrinsics(map, problem.keyframes, problem.bundle);
  for (const LandmarkId id : map.landmark_ids()) {
    const Landmark& landmark = *map.find_landmark(id);
    if (landmark.observations.size() < 2 || map.find_keyframe(landmark.reference)->map != component) continue;
    const auto point = static_cast<std::uint32_t>(problem.landmarks.size());
    problem.landmarks.push_back(id);
    problem.bundle.points.push_back(landmark.position);
    add_observations(map, landmark, point, problem);
  }
  return problem;
}

BundleSummary adjust_globally(GlobalProblem& problem, const GlobalBundleOptions& options) {
  BundleOptions bundle;
  bundle.iterations_robust = options.iterations;
  bundle.iterations = 0;
  bundle.solver = BundleSolver::kSparse;
  bundle.threads = options.threads;
  bundle.interrupted = options.interrupted;
  return adjust_bundle(problem.bundle, bundle);
}

void apply_global_problem(Map& map, const GlobalProblem& problem) {
  move_keyframes(map, follow_parents(map, problem));
  for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
    Landmark* landmark = map.find_landmark(problem.landmarks[i]);
    if (landmark == nullptr) continue;
    landmark->position = problem.bundle.points[i];
    map.refresh_geometry(landmark->id);
  }
}

void GlobalAdjuster::run_in_background(std::function<void()> on_done) {
  background_ = true;
  on_done_ = std::move(on_done);
}

void GlobalAdjuster::start(GlobalProblem problem) {
  cancel();
  cancelled_ = false;
  if (!background_) {
    adjust(std::move(problem));
    return;
  }
  thread_ = std::thread([this, own = std::move(problem)]() mutable {
    adjust(std::move(own));
    if (!cancelled_ && on_done_) on_done_();
  });
}

void GlobalAdjuster::adjust(GlobalProblem problem) {
  GlobalBundleOptions options = options_;
  options.interrupted = [this] { return cancelled_.load(); };
  adjust_globally(problem, options);
  if (cancelled_) return;
  const std::lock_guard lock(mutex_);
  result_ = std::move(problem);
}

void GlobalAdjuster::cancel() {
  cancelled_ = true;
  wait();
  const std::lock_guard lock(mutex_);
  result_.reset();
}

void GlobalAdjuster::wait() {
  if (thread_.joinable()) thread_.join();
}

std::optional<GlobalProblem> GlobalAdjuster::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

}  // namespace rtd::slam
