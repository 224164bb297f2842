// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/slam/core/map/frame.hpp"

namespace rtd::slam {

/// Time of a row relative to the middle one, in units of the readout time. Eq. (1).
double row_time(double v_px, int height_px);

/// How fast a static point in the camera's frame drifts back when the camera's motion is undone, m/s. Eq. (2).
Eigen::Vector3d drift_of(const Eigen::Vector3d& p_camera, const geometry::Vector6d& velocity_per_s);

/// Where (and how deep) a feature would have been seen had its row been exposed together with the middle one.
/// Eq. (1), (2). A feature without depth is taken for far away: only the rotation moves it.
msg::Feature undo_rolling_shutter(const msg::Feature& feature, const vision::RgbdProjection& camera, int height_px,
                                  const ShutterMotion& motion);

}  // namespace rtd::slam
