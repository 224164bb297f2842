// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/motion_prediction.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace rtd::slam {

PredictedPose predict_motion(const CameraMotion& motion, double gap_s, const PredictionConfig& config) {
  const double tau_s = config.velocity_decay_s;
  const double reach_s = tau_s * (1 - std::exp(-gap_s / tau_s));
  const geometry::Vector6d& velocity = motion.velocity_per_s;
  PredictedPose predicted;
  predicted.T_world_camera = geometry::normalized(motion.T_world_camera * geometry::se3_exp(reach_s * velocity));

  // A wrong direction at the start becomes a wrong place at the end.
  const Eigen::Vector3d way_m = predicted.T_world_camera.translation() - motion.T_world_camera.translation();
  geometry::Matrix6d F = geometry::Matrix6d::Identity();
  F.topRightCorner<3, 3>() = -geometry::skew(way_m);
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
  geometry::Vector6d difference;
  difference << b.T_world_camera.translation() - a.T_world_camera.translation(),
      geometry::so3_log(b.T_world_camera.linear() * a.T_world_camera.linear().transpose());
  const geometry::Matrix6d covariance = a.covariance + b.covariance;
  return difference.dot(covariance.ldlt().solve(difference));
}

}  // namespace rtd::slam
