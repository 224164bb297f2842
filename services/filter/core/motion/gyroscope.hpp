// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "common/inertial/camera_turn.hpp"
#include "services/filter/core/motion/motion_config.hpp"

namespace rtd::filter {

/// Turns of the camera from the samples of an IMU. docs/theory/dynamic_points.md section 2. Not thread-safe.
class Gyroscope {
 public:
  explicit Gyroscope(const GyroscopeConfig& config) : config_(config) {}

  void add(inertial::ImuSample sample);
  /// Empty when the samples do not cover the span.
  std::optional<inertial::CameraTurn> turn(std::int64_t from_ns, std::int64_t to_ns) const;
  /// Everything older than any view is forgotten.
  void forget_before(std::int64_t stamp_ns) { samples_.forget_before(stamp_ns); }
  void clear() { samples_.clear(); }

 private:
  GyroscopeConfig config_;
  inertial::ImuStream samples_;
};

}  // namespace rtd::filter
