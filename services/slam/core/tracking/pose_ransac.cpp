// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/pose_ransac.hpp"

#include <algorithm>
#include <array>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <random>

#include "common/geometry/se3.hpp"

namespace rtd::slam {
namespace {

using vision::PoseObservation;

Eigen::Vector3d unproject(const vision::RgbdProjection& camera, const vision::RgbdMeasurement& measured) {
  return {(measured.pixel.x() - camera.cx) / camera.fx * measured.depth_m,
          (measured.pixel.y() - camera.cy) / camera.fy * measured.depth_m, measured.depth_m};
}

int count_inliers(const vision::RgbdProjection& camera, const std::vector<PoseObservation>& observations,
                  const Eigen::Isometry3d& T_camera_world, double max_error_px) {
  return static_cast<int>(std::ranges::count_if(observations, [&](const PoseObservation& observation) {
    return agrees(camera, observation, T_camera_world, max_error_px);
  }));
}

/// Three observations drawn for a hypothesis.
using Triple = std::array<const PoseObservation*, 3>;

/// T_camera_world by least-squares alignment of three points that are known in both frames.
std::vector<Eigen::Isometry3d> align_points(const vision::RgbdProjection& camera, const Triple& triple) {
  Eigen::Matrix3d world, camera_points;
  for (int k = 0; k < 3; ++k) {
    world.col(k) = triple[static_cast<std::size_t>(k)]->p_world;
    camera_points.col(k) = unproject(camera, triple[static_cast<std::size_t>(k)]->measured);
  }
  Eigen::Isometry3d T_camera_world;
  T_camera_world.matrix() = Eigen::umeyama(world, camera_points, false);
  return {T_camera_world};
}

/// Up to four T_camera_world that show three points where they were seen (P3P).
std::vector<Eigen::Isometry3d> solve_p3p(const vision::RgbdProjection& camera, const Triple& triple) {
  std::array<cv::Point3d, 3> points;
  std::array<cv::Point2d, 3> rays;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d& p = triple[k]->p_world;
    const Eigen::Vector2d& pixel = triple[k]->measured.pixel;
    points[k] = {p.x(), p.y(), p.z()};
    rays[k] = {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy};
  }
  std::vector<cv::Vec3d> turns, shifts;
  cv::solveP3P(points, rays, cv::Matx33d::eye(), cv::noArray(), turns, shifts, cv::SOLVEPNP_AP3P);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    Eigen::Isometry3d T_camera_world(geometry::so3_exp({turns[i][0], turns[i][1], turns[i][2]}));
    T_camera_world.translation() = Eigen::Vector3d(shifts[i][0], shifts[i][1], shifts[i][2]);
    poses.push_back(T_camera_world);
  }
  return poses;
}

/// Three different ones; empty when the draw doubled one.
std::optional<Triple> draw(const std::vector<const PoseObservation*>& from, std::mt19937_64& random) {
  // Plain modulo, not std::uniform_int_distribution: the same numbers with every standard library.
  Triple triple{};
  for (const PoseObservation*& observation : triple) observation = from[random() % from.size()];
  if (triple[0] == triple[1] || triple[0] == triple[2] || triple[1] == triple[2]) return std::nullopt;
  return triple;
}

}  // namespace

bool agrees(const vision::RgbdProjection& camera, const PoseObservation& observation,
            const Eigen::Isometry3d& T_camera_world, double max_error_px) {
  const Eigen::Vector3d p_camera = T_camera_world * observation.p_world;
  if (p_camera.z() < vision::kMinProjectionDepth_m) return false;
  const Eigen::Vector3d residual = vision::rgbd_residual(camera, p_camera, observation.measured);
  return residual.squaredNorm() < std::pow(max_error_px * observation.sigma_px, 2);
}

PoseRansacResult estimate_pose_ransac(const vision::RgbdProjection& camera,
                                      const std::vector<PoseObservation>& observations,
                                      const PoseRansacOptions& options) {
  PoseRansacResult best;
  std::vector<const PoseObservation*> with_depth, all;
  for (const PoseObservation& observation : observations) {
    all.push_back(&observation);
    if (observation.measured.has_depth()) with_depth.push_back(&observation);
  }
  if (all.size() < 3) return best;
  const bool aligned = static_cast<int>(with_depth.size()) >= options.min_with_depth;
  std::mt19937_64 random(options.seed);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const auto triple = draw(aligned ? with_depth : all, random);
    if (!triple) continue;
    for (const Eigen::Isometry3d& T_camera_world :
         aligned ? align_points(camera, *triple) : solve_p3p(camera, *triple)) {
      if (!T_camera_world.matrix().allFinite()) continue;
      const int inliers = count_inliers(camera, observations, T_camera_world, options.max_error_px);
      if (inliers > best.inliers) best = {inliers >= options.min_inliers, T_camera_world.inverse(), inliers};
    }
  }
  return best;
}

}  // namespace rtd::slam
