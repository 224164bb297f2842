// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/readout_estimator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/vision/pose_optimizer.hpp"
#include "services/slam/core/map/frame.hpp"

namespace rtd::slam {
namespace {

using geometry::Matrix6d;
using geometry::Vector6d;

/// Residuals of one frame share the errors of map and calibration: together they carry less information than so many
/// independent ones. Factor on the variance.
constexpr double kVarianceInflation = 9.0;
constexpr double kMinSureReadout_s = 0.004, kMaxReadout_s = 0.05, kSureSigmas = 4.0;
/// The map is made of the same images and has taken up a part of the effect: only the rest shows. Measured: the
/// estimate falls short by this factor, whatever readout time was undone before.
constexpr double kVisibleShare = 0.5;
constexpr double kMaxChi2 = 9.0;  // larger residuals come from wrong matches

/// Derivative of the residual (predicted minus measured) by the readout time. Eq. (3).
Eigen::Vector3d readout_jacobian(const Frame& frame, std::uint32_t feature, const Eigen::Vector3d& p_camera,
                                 const Vector6d& velocity_per_s) {
  const vision::RgbdMeasurement measured = frame.measurement(feature);
  const double tau = row_time(measured.pixel.y(), frame.height_px);
  // Moving the measurement by dm changes the residual by -dm.
  return -tau * vision::rgbd_jacobian(frame.camera, p_camera, measured) * drift_of(p_camera, velocity_per_s);
}

}  // namespace

void ReadoutEstimator::add(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                           const std::vector<Association>& points, const ShutterMotion& motion) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  Matrix6d H = Matrix6d::Zero();
  Vector6d H_xs = Vector6d::Zero(), b_x = Vector6d::Zero();
  double H_ss = 0, b_s = 0;
  for (const Association& point : points) {
    const Eigen::Vector3d p_rotated = T_camera_world.linear() * point.p_world;
    const Eigen::Vector3d p_camera = p_rotated + T_camera_world.translation();
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    const vision::RgbdMeasurement measured = frame.measurement(point.feature);
    const double weight =
        frame.features[point.feature].static_probability / std::pow(sigma_px(frame.features[point.feature].octave), 2);
    const Eigen::Vector3d residual = vision::rgbd_residual(frame.camera, p_camera, measured);
    if (weight * residual.squaredNorm() > kMaxChi2) continue;
    const Eigen::Matrix<double, 3, 6> J =
        vision::pose_jacobian(frame.camera, p_rotated, p_camera, Eigen::Matrix3d::Identity(), measured);
    const Eigen::Vector3d g = readout_jacobian(frame, point.feature, p_camera, motion.velocity_per_s);
    H += weight * J.transpose() * J;
    H_xs += weight * J.transpose() * g;
    H_ss += weight * g.squaredNorm();
    b_x -= weight * J.transpose() * residual;
    b_s -= weight * g.dot(residual);
  }
  // What the pose explains is taken out. Eq. (4).
  const Eigen::LDLT<Matrix6d> factor(H);
  if (factor.info() != Eigen::Success || !factor.isPositive() || H_ss <= 0) return;
  const Vector6d explained = factor.solve(H_xs);
  const double information = H_ss - H_xs.dot(explained), right_side = b_s - b_x.dot(explained);
  if (!std::isfinite(information) || !std::isfinite(right_side) || information <= 0) return;
  information_ += information;
  // In terms of the whole readout time, Eq. (5).
  weighted_sum_ += right_side / kVisibleShare + information * motion.readout_s;
}

double ReadoutEstimator::estimate_s() const {
  return information_ > 0 ? weighted_sum_ / information_ : 0;
}

double ReadoutEstimator::sigma_s() const {
  return information_ > 0 ? std::sqrt(kVarianceInflation / information_) / kVisibleShare
                          : std::numeric_limits<double>::infinity();
}

double ReadoutEstimator::readout_s() const {
  const double readout_s = estimate_s();
  const bool sure = std::abs(readout_s) > std::max(kMinSureReadout_s, kSureSigmas * sigma_s());
  return sure ? std::clamp(readout_s, -kMaxReadout_s, kMaxReadout_s) : 0;
}

}  // namespace rtd::slam
