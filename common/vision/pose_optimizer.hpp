// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/vision/reprojection.hpp"

namespace rtd::vision {

/// A world point seen in the image whose camera pose is wanted.
struct PoseObservation {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  ///< m
  RgbdMeasurement measured;
  double sigma_px = 1.0;  ///< standard deviation of the keypoint, 1.2^octave
  double weight = 1.0;    ///< [0, 1] factor on the squared residual: the static probability
};

enum class RobustKernel : std::uint8_t {
  kHuber,     ///< threshold max_chi2_*, whatever the residuals are like
  kAdaptive,  ///< from the second round on, scale and shape fitted to its residuals: general_loss.hpp
};

/// How the camera is turned, as something else than its image knows it.
struct RotationPrior {
  Eigen::Matrix3d R_world_camera = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of a small turn in the camera's axes, rad^2; regular
};

/// Where the camera is, as its motion so far lets expect.
struct PositionPrior {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  double sigma_m = 1;  ///< along each axis
};

struct PoseOptimizerOptions {
  RobustKernel kernel = RobustKernel::kHuber;
  int rounds = 4;           ///< optimise, then sort inliers from outliers
  int robust_rounds = 2;    ///< rounds with the Huber loss; the later ones trust the inliers (adaptive: none does)
  int max_iterations = 10;  ///< of each round
  double max_chi2_pixel = 5.991;          ///< 95 % of chi2 with 2 degrees of freedom: observations without depth
  double max_chi2_rgbd = 7.815;           ///< 3 degrees of freedom: observations with depth
  int min_inliers = 6;                    ///< fewer end the optimisation as failed
  std::optional<RotationPrior> rotation;  ///< one more residual: docs/theory/tracking.md Eq. (19)
  std::optional<PositionPrior> position;  ///< another one, Eq. (20); not where the image shows more than 4 sigma
};

struct PoseOptimizerResult {
  bool success = false;  ///< enough inliers and a pose that they determine in all six directions
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<char> inlier;  ///< per observation, 1 = inlier (vector<bool> has no plain elements)
  int inliers = 0;
  double rmse_px = 0;  ///< of the inliers, in units of their sigma
  /// Covariance of (x y z rx ry rz), m and rad, world frame: p' = p + d, R' = exp(r) R. docs/theory/tracking.md Eq.
  /// (4).
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
  geometry::Matrix6d image_covariance = geometry::Matrix6d::Zero();  ///< the same without what a known rotation adds
};

/// Robust pose of one camera against fixed world points, docs/theory/tracking.md Eq. (1)-(4).
///
/// Minimises sum_i w_i rho(|r_i / sigma_i|^2) over T_camera_world (pose_solver.hpp); observations whose chi2 is too
/// large after a round, or that lie behind the camera, sit out the next one and may come back. Deterministic.
PoseOptimizerResult optimize_pose(const RgbdProjection& camera, const std::vector<PoseObservation>& observations,
                                  const Eigen::Isometry3d& T_world_camera_initial,
                                  const PoseOptimizerOptions& options = {});

/// The 3x6 derivative of p_camera = exp(phi) R p_world + t + rho with respect to [rho; phi], given `p_rotated` =
/// exp(phi) R p_world and so3_left_jacobian(phi). docs/theory/tracking.md Eq. (2).
Eigen::Matrix<double, 3, 6> point_jacobian(const Eigen::Vector3d& p_rotated, const Eigen::Matrix3d& left_jacobian);

/// The 3x6 derivative of rgbd_residual with respect to [rho; phi] in p_camera = exp(phi) R p_world + t + rho, given
/// `p_rotated` = exp(phi) R p_world, p_camera and so3_left_jacobian(phi), the same for all points of a camera.
/// docs/theory/tracking.md Eq. (2).
Eigen::Matrix<double, 3, 6> pose_jacobian(const RgbdProjection& camera, const Eigen::Vector3d& p_rotated,
                                          const Eigen::Vector3d& p_camera, const Eigen::Matrix3d& left_jacobian,
                                          const RgbdMeasurement& measured);

}  // namespace rtd::vision
