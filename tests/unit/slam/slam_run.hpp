// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam::test {

/// The features are those of a camera that is known exactly.
inline SlamSystem make_slam(MappingMode mode = MappingMode::kSynchronous) {
  SlamConfig config = test_support::settled();
  config.sensor.calibration_error = 0;
  return {config, mode, test_support::frozen_clock};
}

inline double position_error_m(const Eigen::Isometry3d& estimate, std::uint64_t seq) {
  return (estimate.translation() - test_support::FeatureWorld::T_world_camera(seq).translation()).norm();
}

}  // namespace rtd::slam::test
