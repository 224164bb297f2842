// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/facts.hpp"

#include <Eigen/Dense>
#include <limits>

namespace rtd::slam {
namespace {

/// What one observation says about the point: J' J / sigma^2 in the world frame, docs/theory/camera.md Eq. (7).
Eigen::Matrix3d information_of(const Keyframe& keyframe, const Landmark& landmark, std::uint32_t feature) {
  const Eigen::Isometry3d T_camera_world = keyframe.T_world_camera.inverse();
  const Eigen::Vector3d p_camera = T_camera_world * landmark.position;
  if (p_camera.z() < vision::kMinProjectionDepth_m) return Eigen::Matrix3d::Zero();
  const Frame& frame = *keyframe.frame;
  const Eigen::Matrix3d jacobian =
      vision::rgbd_jacobian(frame.camera, p_camera, frame.measurement(feature)) * T_camera_world.linear();
  const double sigma = sigma_px(frame.features[feature].octave);
  return jacobian.transpose() * jacobian / (sigma * sigma);
}

const Landmark* nearest_landmark(const Map& map, const Keyframe& keyframe, const Eigen::Vector3d& p_camera) {
  const Eigen::Vector3d p_world = keyframe.T_world_camera * p_camera;
  const Landmark* nearest = nullptr;
  double least_m = 0.01 + 0.05 * p_camera.norm();  // a map that is shown lags behind
  for (const LandmarkId id : keyframe.landmarks) {
    const Landmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark == nullptr || landmark->reference != keyframe.id) continue;
    const double apart_m = (landmark->position - p_world).norm();
    if (!(apart_m < least_m)) continue;
    least_m = apart_m;
    nearest = landmark;
  }
  return nearest;
}

}  // namespace

std::optional<LandmarkFacts> facts_of_landmark(const Map& map, KeyframeId keyframe, const Eigen::Vector3d& p_camera) {
  const Keyframe* owner = map.find_keyframe(keyframe);
  const Landmark* landmark = owner == nullptr ? nullptr : nearest_landmark(map, *owner, p_camera);
  if (landmark == nullptr) return std::nullopt;
  LandmarkFacts facts;
  facts.id = landmark->id;
  facts.p_world = landmark->position;
  facts.static_probability = landmark->static_probability;
  facts.visible = landmark->visible;
  facts.found = landmark->found;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Observation& observation : landmark->observations) {
    const Keyframe& by = *map.find_keyframe(observation.keyframe);
    facts.seen_ns.push_back(by.frame->stamp_ns);
    information += information_of(by, *landmark, observation.feature);
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(information);
  if (solver.isInvertible()) facts.covariance = solver.inverse();
  return facts;
}

}  // namespace rtd::slam
