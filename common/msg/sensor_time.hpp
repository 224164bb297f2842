// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace rtd::msg {

/// Bound of a sensor's readout time and of the time between its colour and depth image, s, of either sign.
inline constexpr double kMaxSensorTime_s = 0.1;

/// Whether such a time is finite and within its bound.
inline bool is_sensor_time(double time_s) {
  return std::abs(time_s) <= kMaxSensorTime_s;
}

}  // namespace rtd::msg
