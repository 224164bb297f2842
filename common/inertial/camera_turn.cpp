// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/inertial/camera_turn.hpp"

#include "common/geometry/se3.hpp"

namespace rtd::inertial {

CameraTurn turn_of_camera(const Preintegration& motion, const Eigen::Matrix3d& R_camera_imu,
                          const GyroscopeErrors& errors) {
  const Eigen::Matrix3d by_bias = motion.bias_jacobian().topLeftCorner<3, 3>();
  const double scale_rad = errors.scale_error * geometry::so3_log(motion.rotation()).norm();
  const Eigen::Matrix3d covariance = motion.covariance().topLeftCorner<3, 3>() +
                                     by_bias * errors.bias_covariance * by_bias.transpose() +
                                     scale_rad * scale_rad * Eigen::Matrix3d::Identity();
  return {R_camera_imu * motion.rotation() * R_camera_imu.transpose(),
          R_camera_imu * covariance * R_camera_imu.transpose()};
}

}  // namespace rtd::inertial
