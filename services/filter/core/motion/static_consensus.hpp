// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/se3.hpp"
#include "common/vision/pose_optimizer.hpp"
#include "services/filter/core/config/filter_config.hpp"

namespace rtd::filter {

/// A point known in the world and measured in the current image.
struct PointSighting {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();    ///< undistorted
  double depth_m = 0;                                 ///< 0 = not measured
  double sigma_px = 1;                                ///< of the displacement between the two sightings
  int cluster = -1;                                   ///< depth cluster it lies on
};

/// Standard deviation of the displacement of a keypoint between two views: both ends are uncertain. px of the image.
double displacement_sigma_px(int octave, const geometry::CameraModel& camera);

/// From where the point would appear at rest to where it was seen; nullopt if it lies behind the camera.
std::optional<Eigen::Vector2d> displacement_px(const PointSighting& sighting, const geometry::CameraModel& camera,
                                               const Eigen::Isometry3d& T_camera_world);

/// Squared displacement in the image in units of sigma: about chi2 with 2 degrees of freedom for a point at rest.
double displacement_chi2(const PointSighting& sighting, const geometry::CameraModel& camera,
                         const Eigen::Isometry3d& T_camera_world);

/// How the camera is turned by a gyroscope; empty without one.
using KnownRotation = std::optional<vision::RotationPrior>;

/// Robust least squares over some sightings (common/vision/pose_optimizer).
struct RefinedPose {
  bool success = false;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int inliers = 0;
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();  ///< of (position, rotation) in the world
};
RefinedPose refine_pose(const std::vector<PointSighting>& sightings, const geometry::CameraModel& camera,
                        const Eigen::Isometry3d& T_world_camera_start, int min_inliers,
                        const KnownRotation& rotation = {});

/// The camera motion that the largest part of the IMAGE agrees with.
struct StaticConsensus {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  double image_share = 0;  ///< how much of the image agrees, 1 = all of it exactly
};

/// Every large surface (depth cluster) proposes the motion under which it stands still, all sightings together propose
/// one, and the prediction is one. The image decides: every 40 px tile has one vote, which its sightings share, so that
/// a mover with much texture does not outvote plain walls. Agreement is graded (1 - chi2/limit), since a shift of the
/// camera and a rotation nearly cancel on distant walls: a wrong motion that carries the mover along shows only in many
/// small residuals. docs/theory/dynamic_points.md section 2.
StaticConsensus find_static_consensus(const std::vector<PointSighting>& sightings, const geometry::CameraModel& camera,
                                      const Eigen::Isometry3d& T_world_camera_predicted, const EgoMotionConfig& config,
                                      const KnownRotation& rotation = {});

}  // namespace rtd::filter
