// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/readout_estimator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/vision/pose_optimizer.hpp"
#include "common/vision/samples.hpp"
#include "services/slam/core/map/frame.hpp"

namespace rtd::slam {
namespace {

/// Of the ratio of the residuals, the share that gives the best trajectories: errors of depth are shared by neighbours,
/// those of pixels are not.
constexpr double kShareOfRatio = 0.45;
constexpr double kInitialDepths = 2000, kMaxDepths = 20'000;  ///< what the start counts, and for how long a frame does
constexpr std::size_t kMinDepths = 30;
/// More than the largest never paid: corners lie on edges, where depth jumps, whatever the sensor.
constexpr double kMin_px_m = 10, kMax_px_m = 80;
constexpr double kStep = 1.1;
/// Residuals below these come from rounding, not from a sensor.
constexpr double kMinPixel_px = 0.05, kMinInverseDepth_per_m = 5e-5;

using geometry::Matrix6d;
using geometry::Vector6d;

/// Residuals of one frame share the errors of map and calibration: together they carry less information than so many
/// independent ones. Factor on the variance.
constexpr double kVarianceInflation = 9.0;
constexpr double kMinSureReadout_s = 0.004, kMaxReadout_s = 0.05, kSureSigmas = 2.5;
constexpr double kMaxChi2 = 9.0;  // larger residuals come from wrong matches

constexpr std::size_t kMaxFrames = 2048;  ///< of which it is remembered how they were exposed

/// How a point moves in the camera's frame when the pose changes by this (vision::pose_jacobian).
Eigen::Vector3d moved_by(const Vector6d& pose, const Eigen::Vector3d& p_rotated) {
  return pose.head<3>() + pose.tail<3>().cross(p_rotated);
}

/// A displacement that depends on the readout time s: slope * s - offset, m, world frame.
struct Displacement {
  Eigen::Vector3d slope = Eigen::Vector3d::Zero(), offset = Eigen::Vector3d::Zero();
};

/// How the readout time has displaced a landmark, by the frames that it was mapped from; empty when none is known.
/// Eq. (3).
std::optional<Displacement> displacement_of_landmark(const LocalLandmark& landmark, const LocalMap& map,
                                                     const std::map<std::uint64_t, ExposedFrame>& exposed) {
  Displacement mean;
  int count = 0;
  for (std::uint32_t i = 0; i < landmark.observers; ++i) {
    const LocalKeyframe& keyframe = map.keyframes[map.observers[landmark.first_observer + i]];
    const auto known = exposed.find(keyframe.frame->seq);
    if (known == exposed.end()) continue;
    const ExposedFrame& then = known->second;
    const Eigen::Matrix3d R_camera_world = keyframe.T_world_camera.linear().transpose();
    const Eigen::Vector3d p_rotated = R_camera_world * landmark.position;
    const Eigen::Vector3d p_camera = p_rotated - R_camera_world * keyframe.T_world_camera.translation();
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    const vision::RgbdProjection& camera = keyframe.frame->camera;
    const double v_px = camera.fy * p_camera.y() / p_camera.z() + camera.cy;
    const Eigen::Vector3d swept = row_time(v_px, keyframe.frame->height_px) * drift_of(p_camera, then.velocity_per_s);
    const Eigen::Matrix3d& R_world_camera = keyframe.T_world_camera.linear();
    mean.slope += R_world_camera * (moved_by(then.pose_slope, p_rotated) - swept);
    mean.offset += R_world_camera * (moved_by(then.pose_offset, p_rotated) - then.readout_s * swept);
    ++count;
  }
  if (count == 0) return std::nullopt;
  mean.slope /= count;
  mean.offset /= count;
  return mean;
}

}  // namespace

DepthWeightEstimator::DepthWeightEstimator(double disparity_px_m)
    : weighted_log_sum_(kInitialDepths * std::log(disparity_px_m)),
      depths_(kInitialDepths),
      disparity_px_m_(disparity_px_m) {}

void DepthWeightEstimator::add(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                               const std::vector<Association>& points) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  std::vector<double> pixels_px, inverse_depths_per_m;
  pixels_px.reserve(2 * points.size());
  inverse_depths_per_m.reserve(points.size());
  for (const Association& point : points) {
    const Eigen::Vector3d p_camera = T_camera_world * point.p_world;
    const vision::RgbdMeasurement measured = frame.measurement(point.feature);
    if (p_camera.z() < vision::kMinProjectionDepth_m || !measured.has_depth()) continue;
    const Eigen::Vector3d residual = vision::rgbd_residual(frame.camera, p_camera, measured);
    const double sigma = sigma_px(frame.features[point.feature].octave);
    pixels_px.push_back(std::abs(residual.x()) / sigma);
    pixels_px.push_back(std::abs(residual.y()) / sigma);
    inverse_depths_per_m.push_back(std::abs(residual.z()) / (sigma * frame.camera.disparity_px_m));
  }
  if (inverse_depths_per_m.size() < kMinDepths) return;
  const auto depths = static_cast<double>(inverse_depths_per_m.size());
  const double ratio_px_m = std::max(vision::median(std::move(pixels_px)), kMinPixel_px) /
                            std::max(vision::median(std::move(inverse_depths_per_m)), kMinInverseDepth_per_m);
  weighted_log_sum_ += depths * std::log(kShareOfRatio * ratio_px_m);
  depths_ += depths;
  const double kept = std::min(1.0, kMaxDepths / depths_);
  weighted_log_sum_ *= kept;
  depths_ *= kept;
  const double estimate_px_m = std::clamp(std::exp(weighted_log_sum_ / depths_), kMin_px_m, kMax_px_m);
  while (estimate_px_m >= kStep * disparity_px_m_) disparity_px_m_ *= kStep;
  while (estimate_px_m * kStep <= disparity_px_m_) disparity_px_m_ /= kStep;
}

ReadoutEstimator::ReadoutEstimator(double readout_s) {
  constexpr double kSigma_s = 0.0015;  // of an estimate that was sure
  if (readout_s == 0) return;
  information_ = kVarianceInflation / (kSigma_s * kSigma_s);
  weighted_sum_ = information_ * readout_s;
}

void ReadoutEstimator::add(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                           const std::vector<Association>& points, const LocalMap& map, const ShutterMotion& motion) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  Matrix6d H = Matrix6d::Zero();
  Vector6d Jg = Vector6d::Zero(), Jd = Vector6d::Zero(), Jr = Vector6d::Zero();
  double gg = 0, gr = 0;
  for (const Association& point : points) {
    const LocalLandmark* landmark = map.find_landmark(point.landmark);
    const auto displaced = landmark == nullptr ? std::nullopt : displacement_of_landmark(*landmark, map, exposed_);
    if (!displaced) continue;
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
    const auto J_point = vision::rgbd_jacobian(frame.camera, p_camera, measured);
    const Eigen::Vector3d swept =
        row_time(measured.pixel.y(), frame.height_px) * drift_of(p_camera, motion.velocity_per_s);
    // The residual is g * readout - d, Eq. (4).
    const Eigen::Vector3d g = J_point * (swept + T_camera_world.linear() * displaced->slope);
    const Eigen::Vector3d d = J_point * (motion.readout_s * swept + T_camera_world.linear() * displaced->offset);
    H += weight * J.transpose() * J;
    Jg += weight * J.transpose() * g;
    Jd += weight * J.transpose() * d;
    Jr += weight * J.transpose() * (residual + d);
    gg += weight * g.squaredNorm();
    gr += weight * g.dot(residual + d);
  }
  // What the pose explains is taken out. Eq. (5).
  const Eigen::LDLT<Matrix6d> factor(H);
  ExposedFrame exposed{motion.velocity_per_s, motion.readout_s};
  if (factor.info() == Eigen::Success && factor.isPositive() && gg > 0) {
    exposed.pose_slope = factor.solve(Jg);
    exposed.pose_offset = factor.solve(Jd);
    const double information = gg - Jg.dot(exposed.pose_slope), right_side = gr - Jg.dot(factor.solve(Jr));
    if (std::isfinite(information) && std::isfinite(right_side) && information > 0) {
      information_ += information;
      weighted_sum_ += right_side;
    }
  }
  if (!exposed.pose_slope.allFinite() || !exposed.pose_offset.allFinite()) {
    exposed.pose_slope.setZero();
    exposed.pose_offset.setZero();
  }
  exposed_[frame.seq] = exposed;
  if (exposed_.size() > kMaxFrames) exposed_.erase(exposed_.begin());
}

double ReadoutEstimator::estimate_s() const {
  return information_ > 0 ? weighted_sum_ / information_ : 0;
}

double ReadoutEstimator::sigma_s() const {
  return information_ > 0 ? std::sqrt(kVarianceInflation / information_) : std::numeric_limits<double>::infinity();
}

double ReadoutEstimator::readout_s() const {
  const double readout_s = estimate_s();
  const bool sure = std::abs(readout_s) > std::max(kMinSureReadout_s, kSureSigmas * sigma_s());
  return sure ? std::clamp(readout_s, -kMaxReadout_s, kMaxReadout_s) : 0;
}

}  // namespace rtd::slam
