// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/rolling_shutter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/vision/pose_optimizer.hpp"
#include "services/slam/core/scale_pyramid.hpp"

namespace rtd::slam {
namespace {

using geometry::Matrix6d;
using geometry::Vector6d;

/// Residuals of one frame share the errors of map and calibration: together they say less than so many independent
/// ones. Factor on the variance.
constexpr double kVarianceInflation = 9.0;
constexpr double kMinSureReadout_s = 0.004, kMaxReadout_s = 0.05, kSureSigmas = 4.0;
/// The map is made of the same images and has taken up a part of the effect: only the rest shows. Measured: the
/// estimate falls short by this factor, whatever readout time was undone before.
constexpr double kVisibleShare = 0.5;
constexpr double kMaxChi2 = 9.0;  // residuals beyond tell of a wrong match

/// Time of a row relative to the middle one, in units of the readout time. Eq. (1).
double row_time(double v_px, int height_px) {
  return v_px / height_px - 0.5;
}

/// Derivative of a point in the camera's frame by time, while the camera moves. Eq. (2), sign as for going back.
Eigen::Vector3d drift_of(const Eigen::Vector3d& p_camera, const Vector6d& velocity_per_s) {
  return velocity_per_s.head<3>() + velocity_per_s.tail<3>().cross(p_camera);
}

/// Derivative of the residual (predicted minus measured) by the readout time. Eq. (3).
Eigen::Vector3d readout_jacobian(const Frame& frame, std::uint32_t feature, const Eigen::Vector3d& p_camera,
                                 const Vector6d& velocity_per_s) {
  const vision::RgbdMeasurement measured = frame.measurement(feature);
  const double tau = row_time(measured.pixel.y(), frame.height_px);
  // Moving the measurement by dm changes the residual by -dm.
  return -tau * vision::rgbd_jacobian(frame.camera, p_camera, measured) * drift_of(p_camera, velocity_per_s);
}

}  // namespace

msg::Feature undo_rolling_shutter(const msg::Feature& feature, const vision::RgbdProjection& camera, int height_px,
                                  const ShutterMotion& motion) {
  constexpr double kMinDepth_m = 0.05;
  const double shift_s = row_time(feature.v_px, height_px) * motion.readout_s;
  const bool deep = feature.depth_m > 0;
  const Eigen::Vector3d ray((feature.u_px - camera.cx) / camera.fx, (feature.v_px - camera.cy) / camera.fy, 1);
  Vector6d velocity = motion.velocity_per_s;
  if (!deep) velocity.head<3>().setZero();
  const Eigen::Vector3d p = deep ? Eigen::Vector3d(feature.depth_m * ray) : ray;
  const Eigen::Vector3d q = p + shift_s * drift_of(p, velocity);
  if (!(q.z() > kMinDepth_m)) return feature;
  msg::Feature moved = feature;
  moved.u_px = static_cast<float>(camera.fx * q.x() / q.z() + camera.cx);
  moved.v_px = static_cast<float>(camera.fy * q.y() / q.z() + camera.cy);
  if (deep) moved.depth_m = static_cast<float>(q.z());
  return moved;
}

void ReadoutEstimator::add(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                           const std::vector<Eigen::Vector3d>& landmarks, const ShutterMotion& motion) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  Matrix6d H = Matrix6d::Zero();
  Vector6d H_xs = Vector6d::Zero(), b_x = Vector6d::Zero();
  double H_ss = 0, b_s = 0;
  for (std::uint32_t i = 0; i < landmarks.size(); ++i) {
    if (!landmarks[i].allFinite()) continue;
    const Eigen::Vector3d p_rotated = T_camera_world.linear() * landmarks[i];
    const Eigen::Vector3d p_camera = p_rotated + T_camera_world.translation();
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    const vision::RgbdMeasurement measured = frame.measurement(i);
    const double weight = frame.features[i].static_probability / std::pow(sigma_px(frame.features[i].octave), 2);
    const Eigen::Vector3d residual = vision::rgbd_residual(frame.camera, p_camera, measured);
    if (weight * residual.squaredNorm() > kMaxChi2) continue;
    const Eigen::Matrix<double, 3, 6> J =
        vision::pose_jacobian(frame.camera, p_rotated, p_camera, Eigen::Matrix3d::Identity(), measured);
    const Eigen::Vector3d g = readout_jacobian(frame, i, p_camera, motion.velocity_per_s);
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
