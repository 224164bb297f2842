// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "common/msg/ros.hpp"

namespace rtd::msg {

/// Topics of rtd-camera's simulated sensors, as raw samples: their readers take any driver's, whatever QoS it offers.
inline constexpr const char* kImuTopic = "rt/imu/data";
inline constexpr const char* kWheelTopic = "rt/wheel/odometry";
inline constexpr const char* kImuDdsType = "sensor_msgs::msg::dds_::Imu_";
inline constexpr const char* kOdometryDdsType = "nav_msgs::msg::dds_::Odometry_";

/// What an IMU driver publishes. A covariance of 0 is unknown; -1 as its first element: the field is not measured.
struct Imu {
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};
  Vector3 angular_velocity;  ///< rad/s
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration;  ///< m/s2, with gravity
  std::array<double, 9> linear_acceleration_covariance{};
};
RTD_FIELDS(sensor_msgs, Imu, header, orientation, orientation_covariance, angular_velocity, angular_velocity_covariance,
           linear_acceleration, linear_acceleration_covariance)

}  // namespace rtd::msg
