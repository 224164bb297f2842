// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/pose_ransac.hpp"

#include <array>
#include <random>

namespace rtd::slam {
namespace {

using vision::PoseObservation;

Eigen::Vector3d unproject(const vision::RgbdProjection& camera, const vision::RgbdMeasurement& measured) {
  return {(measured.pixel.x() - camera.cx) / camera.fx * measured.depth_m,
          (measured.pixel.y() - camera.cy) / camera.fy * measured.depth_m, measured.depth_m};
}

int count_inliers(const vision::RgbdProjection& camera, const std::vector<PoseObservation>& observations,
                  const Eigen::Isometry3d& T_camera_world, double max_error_px) {
  int inliers = 0;
  for (const PoseObservation& observation : observations) {
    const Eigen::Vector3d p_camera = T_camera_world * observation.p_world;
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    const Eigen::Vector3d residual = vision::rgbd_residual(camera, p_camera, observation.measured);
    if (residual.squaredNorm() < std::pow(max_error_px * observation.sigma_px, 2)) ++inliers;
  }
  return inliers;
}

}  // namespace

PoseRansacResult estimate_pose_ransac(const vision::RgbdProjection& camera,
                                      const std::vector<PoseObservation>& observations,
                                      const PoseRansacOptions& options) {
  PoseRansacResult best;
  std::vector<const PoseObservation*> with_depth;
  for (const PoseObservation& observation : observations) {
    if (observation.measured.has_depth()) with_depth.push_back(&observation);
  }
  if (with_depth.size() < 3) return best;
  std::mt19937_64 random(options.seed);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Eigen::Matrix3d world, camera_points;
    std::array<std::size_t, 3> sample{};
    for (int k = 0; k < 3; ++k) {
      // Plain modulo, not std::uniform_int_distribution: the same numbers with every standard library.
      const std::size_t i = sample[static_cast<std::size_t>(k)] = random() % with_depth.size();
      world.col(k) = with_depth[i]->p_world;
      camera_points.col(k) = unproject(camera, with_depth[i]->measured);
    }
    if (sample[0] == sample[1] || sample[0] == sample[2] || sample[1] == sample[2]) continue;
    Eigen::Isometry3d T_camera_world;
    T_camera_world.matrix() = Eigen::umeyama(world, camera_points, false);
    if (!T_camera_world.matrix().allFinite()) continue;
    const int inliers = count_inliers(camera, observations, T_camera_world, options.max_error_px);
    if (inliers <= best.inliers) continue;
    best = {inliers >= options.min_inliers, T_camera_world.inverse(), inliers};
  }
  return best;
}

}  // namespace rtd::slam
