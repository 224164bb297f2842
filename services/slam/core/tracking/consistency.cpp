// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/vision/samples.hpp"

namespace rtd::slam {
namespace {

constexpr double kUsualResidual = 0.6;  ///< median of a good pose, in units of sigma_px()
constexpr int kMinMatches = 20;         ///< the share of fewer says nothing

/// Median distance of the landmarks from their features, in units of sigma_px().
double median_residual(const Frame& frame, const LocalMap& map, const PoseGuess& pose) {
  const Eigen::Isometry3d T_camera_world = pose.T_world_camera.inverse();
  std::vector<double> residuals;
  residuals.reserve(pose.landmarks.size());
  for (std::uint32_t i = 0; i < pose.landmarks.size(); ++i) {
    const LandmarkId id = pose.landmarks[i];
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark == nullptr) continue;
    const Eigen::Vector3d p_camera = T_camera_world * landmark->position;
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    const Eigen::Vector3d residual = vision::rgbd_residual(frame.camera, p_camera, frame.measurement(i));
    residuals.push_back(residual.head<2>().norm() / sigma_px(frame.features[i].octave));
  }
  return residuals.empty() ? kUsualResidual : vision::median(std::move(residuals));
}

}  // namespace

void Consistency::add(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking, double elapsed_s) {
  const double matched = tracking.guess.inliers + static_cast<double>(tracking.rejected.size());
  if (matched < kMinMatches) return;
  const double residual = median_residual(frame, map, tracking.guess);
  const double now = tracking.guess.inliers / matched * std::min(1.0, kUsualResidual / std::max(residual, 1e-3));
  value_ += (1 - std::exp(-std::max(elapsed_s, 0.0) / config_.memory_s)) * (now - value_);
}

bool Consistency::doubts(double sigma_m) {
  constexpr double kHysteresis = 1.1;
  constexpr double kLargest_m = 0.02;  // 2.5 of them are the 5 cm of docs/integrity.md
  constexpr double kAgreement = 0.7, kGrows = 7;
  if (config_.doubtful_below == 0) return false;
  contradicted_ = value_ < config_.doubtful_below * (contradicted_ ? kHysteresis : 1.0);
  uncertain_ = sigma_m * std::exp(kGrows * (kAgreement - value_)) > kLargest_m / (uncertain_ ? kHysteresis : 1.0);
  return contradicted_ || uncertain_;
}

geometry::Matrix6d Consistency::covariance(double scene_m) const {
  constexpr double kFarthest_m = 1;  ///< where a walker has taken the pose within a second
  constexpr double kLeastScene_m = 0.5;
  const double short_of = std::max(0.0, 1 - value_ / config_.usual);
  const double sigma_m = kFarthest_m * short_of * short_of;
  const double sigma_rad = sigma_m / std::max(scene_m, kLeastScene_m);
  geometry::Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variances.asDiagonal();
}

void Consistency::reset() {
  value_ = kStart;
  contradicted_ = uncertain_ = false;
}

}  // namespace rtd::slam
