// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/pose_uncertainty.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rtd::slam {
namespace {

using geometry::Matrix6d;

/// What an error of the pose (translation, rotation about it) at `from` means at `to`. Eq. (14).
Matrix6d moved(const Matrix6d& covariance, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Matrix6d lever = geometry::lever_arm(to - from);
  return lever * covariance * lever.transpose();
}

/// Index of the oldest keyframe of the window that sees the landmark.
std::uint32_t oldest_observer(const LocalMap& map, const LocalLandmark& landmark) {
  const auto first = map.observers.begin() + landmark.first_observer;
  return *std::min_element(first, first + landmark.observers,
                           [&](std::uint32_t a, std::uint32_t b) { return map.keyframes[a].id < map.keyframes[b].id; });
}

}  // namespace

Eigen::Isometry3d off_motion(const CameraMotion& motion, const Eigen::Isometry3d& T_last_camera, double gap_s) {
  return geometry::se3_exp(gap_s * motion.velocity_per_s).inverse() * T_last_camera;
}

bool is_steady(const CameraMotion& motion, const Eigen::Isometry3d& T_last_camera, double gap_s) {
  constexpr double kMaxAcceleration_m_s2 = 50, kMaxAcceleration_rad_s2 = 200;  // a hand that is struck
  const Eigen::Isometry3d T_expected_camera = off_motion(motion, T_last_camera, gap_s);
  return T_expected_camera.translation().norm() < kMaxAcceleration_m_s2 * gap_s * gap_s &&
         geometry::rotation_angle_rad(T_expected_camera) < kMaxAcceleration_rad_s2 * gap_s * gap_s;
}

PredictedPose predict_motion(const CameraMotion& motion, double gap_s, const PredictionConfig& config) {
  const double tau_s = config.velocity_decay_s;
  const double reach_s = tau_s * (1 - std::exp(-gap_s / tau_s));
  const geometry::Vector6d& velocity = motion.velocity_per_s;
  PredictedPose predicted;
  predicted.T_world_camera = geometry::normalized(motion.T_world_camera * geometry::se3_exp(reach_s * velocity));

  // A wrong direction at the start becomes a wrong place at the end.
  const Eigen::Vector3d way_m = predicted.T_world_camera.translation() - motion.T_world_camera.translation();
  const geometry::Matrix6d F = geometry::lever_arm(way_m);
  predicted.covariance = F * motion.covariance * F.transpose();
  // The velocity is the difference of two poses as uncertain as the last one.
  if (motion.velocity_gap_s > 0) {
    predicted.covariance += 2 * std::pow(reach_s / motion.velocity_gap_s, 2) * motion.covariance;
  }
  // Unknown acceleration, and that by which the fading itself may be wrong.
  const auto variance = [&](double acceleration, double speed) {
    const double fading = speed / tau_s;
    return (acceleration * acceleration + fading * fading) * std::pow(gap_s, 4) / 4;
  };
  predicted.covariance.diagonal().head<3>().array() += variance(config.acceleration_m_s2, velocity.head<3>().norm());
  predicted.covariance.diagonal().tail<3>().array() += variance(config.acceleration_rad_s2, velocity.tail<3>().norm());
  return predicted;
}

double pose_distance2(const PredictedPose& a, const PredictedPose& b) {
  const geometry::Vector6d difference = geometry::pose_difference(a.T_world_camera, b.T_world_camera);
  const geometry::Matrix6d covariance = a.covariance + b.covariance;
  return difference.dot(covariance.ldlt().solve(difference));
}

Matrix6d calibration_covariance(const Eigen::Isometry3d& T_world_camera, double scene_m, double share) {
  const double turn_rad = geometry::rotation_angle_rad(T_world_camera);
  const double way2_m2 = T_world_camera.translation().squaredNorm() + std::pow(turn_rad * scene_m, 2);
  geometry::Vector6d variances;
  variances << Eigen::Vector3d::Constant(way2_m2), Eigen::Vector3d::Constant(turn_rad * turn_rad);
  return (share * share * variances).asDiagonal();
}

Matrix6d MapUncertainty::in_world(const Matrix6d& local, const Eigen::Vector3d& position,
                                  const std::vector<LandmarkId>& landmarks, const LocalMap& map) {
  if (map_ != map.map) of_origin_ = local;
  map_ = map.map;
  return local + of_landmarks(position, landmarks, map);
}

Matrix6d MapUncertainty::of_landmarks(const Eigen::Vector3d& position, const std::vector<LandmarkId>& landmarks,
                                      const LocalMap& map) const {
  std::vector<int> seen(map.keyframes.size(), 0);
  for (const LandmarkId id : landmarks) {
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark != nullptr && landmark->observers > 0) ++seen[oldest_observer(map, *landmark)];
  }
  Matrix6d sum = Matrix6d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] == 0) continue;
    const LocalKeyframe& keyframe = map.keyframes[i];
    sum += seen[i] * moved(keyframe.covariance.value_or(of_origin_), keyframe.T_world_camera.translation(), position);
    count += seen[i];
  }
  return count == 0 ? of_origin_ : Matrix6d(sum / count);
}

}  // namespace rtd::slam
