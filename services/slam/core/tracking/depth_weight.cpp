// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/depth_weight.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

}  // namespace rtd::slam
