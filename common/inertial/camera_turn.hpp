// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/inertial/preintegration.hpp"

namespace rtd::inertial {

/// How the camera has turned between two moments: a vector in the axes of the later one becomes one in those of the
/// earlier. The covariance is of a small turn in the axes of the later moment, rad^2.
struct CameraTurn {
  Eigen::Matrix3d R_earlier_later = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

/// What is not known of a gyroscope.
struct GyroscopeErrors {
  Eigen::Matrix3d bias_covariance = Eigen::Matrix3d::Zero();  ///< of what is left of the bias, (rad/s)^2, IMU's axes
  double scale_error = 0;                                     ///< of it and its clock, share of a turn
};

/// Of the camera to which the IMU is fixed. `R_camera_imu`: from the IMU's axes to the optical frame.
/// docs/theory/dynamic_points.md Eq. (15).
CameraTurn turn_of_camera(const Preintegration& motion, const Eigen::Matrix3d& R_camera_imu,
                          const GyroscopeErrors& errors);

}  // namespace rtd::inertial
