// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/motion_samples.hpp"

namespace rtd::slam {
namespace {

Eigen::Vector3d to_eigen(const msg::Vector3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

ImuSample to_sample(const msg::Imu& imu) {
  return {msg::to_ns(imu.header.stamp), to_eigen(imu.angular_velocity), to_eigen(imu.linear_acceleration)};
}

WheelSample to_sample(const msg::Odometry& odometry) {
  constexpr std::size_t kForward = 0, kTurning = 35;  // places of the variances
  const auto& [p, q] = odometry.pose.pose;
  WheelSample sample;
  sample.stamp_ns = msg::to_ns(odometry.header.stamp);
  sample.T_odom_base.translation() << p.x, p.y, p.z;
  sample.T_odom_base.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  sample.speed_variance = odometry.twist.covariance[kForward];
  sample.turning_variance = odometry.twist.covariance[kTurning];
  return sample;
}

}  // namespace rtd::slam
