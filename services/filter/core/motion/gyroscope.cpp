// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/gyroscope.hpp"

#include <cmath>

#include "common/msg/stamps.hpp"

namespace rtd::filter {

void Gyroscope::add(inertial::ImuSample sample) {
  sample.stamp_ns = msg::plus_ns(sample.stamp_ns, msg::ns_of(config_.time_offset_s));
  samples_.add(sample);
}

std::optional<inertial::CameraTurn> Gyroscope::turn(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto motion = samples_.integrate(from_ns, to_ns, {}, {config_.noise_rad_s_rthz, 0});
  if (!motion) return std::nullopt;
  const Eigen::Matrix3d bias = std::pow(config_.bias_rad_s, 2) * Eigen::Matrix3d::Identity();
  return inertial::turn_of_camera(*motion, config_.R_camera_imu, {bias, config_.scale_error});
}

}  // namespace rtd::filter
