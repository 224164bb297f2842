// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

#include "common/geometry/se3.hpp"

namespace rtd::eval {

/// Normalised estimation error squared of a pose with 6 degrees of freedom, by the covariance that it came with (x y z
/// rx ry rz, m and rad, world frame): 6 in the mean if that is true. docs/theory/tracking.md Eq. (4).
inline double nees(const Eigen::Isometry3d& T_world_camera, const geometry::Matrix6d& covariance,
                   const Eigen::Isometry3d& T_world_camera_true) {
  const geometry::Vector6d error = geometry::pose_difference(T_world_camera_true, T_world_camera);
  return error.dot(covariance.ldlt().solve(error));
}

}  // namespace rtd::eval
