// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/msg/imu.hpp"
#include "services/slam/core/inertial/preintegration.hpp"
#include "services/slam/core/inertial/wheel_stream.hpp"

namespace rtd::slam {

/// The messages of drivers as the core takes them. Whether the values can be is the core's to say.
ImuSample to_sample(const msg::Imu& imu);
WheelSample to_sample(const msg::Odometry& odometry);

}  // namespace rtd::slam
