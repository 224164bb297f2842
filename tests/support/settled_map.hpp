// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/slam/core/config/slam_config.hpp"

namespace rtd::test_support {

/// For worlds in which nothing moves and cameras jump: neither a new map nor a fast motion is doubtful.
inline slam::SlamConfig settled() {
  slam::SlamConfig config;
  config.witness.settle_s = 0;
  config.tracker.max_speed_m_s = 1000;
  config.tracker.max_acceleration_m_s2 = 100'000;
  return config;
}

/// For paths that no hand takes, through maps that are not adjusted: what every frame costs is measured, not the pose.
inline slam::SlamConfig plain() {
  slam::SlamConfig config = settled();
  config.tracker.inertia_m_s2 = 0;
  config.witness.used = false;
  return config;
}

}  // namespace rtd::test_support
