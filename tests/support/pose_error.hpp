// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/evaluation/core/trajectory/integrity.hpp"
#include "services/slam/core/slam_system.hpp"

namespace rtd::test_support {

/// Of a frame's pose and the covariance that it came with: eval::nees().
inline double nees(const slam::FrameResult& result, const Eigen::Isometry3d& T_world_camera) {
  return eval::nees(result.T_world_camera, result.covariance, T_world_camera);
}

}  // namespace rtd::test_support
