// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/rigid_ransac.hpp"

#include <array>
#include <random>

namespace rtd::filter {

std::optional<Eigen::Isometry3d> rigid_ransac(const std::vector<PointPair>& pairs, int iterations,
                                              const geometry::DepthNoise& noise) {
  if (pairs.size() < 3) return std::nullopt;
  std::mt19937_64 random(42);
  std::optional<Eigen::Isometry3d> best;
  int most = 0;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Eigen::Matrix3d in_camera, in_world;
    for (int k = 0; k < 3; ++k) {
      const PointPair& pair = pairs[random() % pairs.size()];
      in_camera.col(k) = pair.p_camera;
      in_world.col(k) = pair.p_world;
    }
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera.matrix() = Eigen::umeyama(in_camera, in_world, false);
    if (!T_world_camera.matrix().allFinite()) continue;
    int agreeing = 0;
    for (const PointPair& pair : pairs) {
      const double limit_m = 0.02 + 3 * noise.sigma_m(pair.p_camera.z());
      agreeing += (T_world_camera * pair.p_camera - pair.p_world).squaredNorm() < limit_m * limit_m ? 1 : 0;
    }
    if (agreeing > most) {
      most = agreeing;
      best = T_world_camera;
    }
  }
  return best;
}

}  // namespace rtd::filter
