// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

#include "common/geometry/se3.hpp"
#include "services/slam/core/slam_system.hpp"

namespace rtd::test_support {

/// Normalised estimation error squared of a pose with 6 degrees of freedom, by the covariance that it came with:
/// 6 in the mean if that is true. docs/theory/tracking.md Eq. (4).
inline double nees(const slam::FrameResult& result, const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Isometry3d& found = result.T_world_camera;
  geometry::Vector6d error;
  error.head<3>() = found.translation() - T_world_camera.translation();
  error.tail<3>() = geometry::so3_log(found.linear() * T_world_camera.linear().transpose());
  return error.dot(result.covariance.ldlt().solve(error));
}

}  // namespace rtd::test_support
