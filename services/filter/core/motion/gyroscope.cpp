// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/gyroscope.hpp"

#include <cmath>

#include "common/geometry/se3.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::filter {

void Gyroscope::add(inertial::ImuSample sample) {
  sample.stamp_ns = msg::plus_ns(sample.stamp_ns, msg::ns_of(config_.time_offset_s));
  samples_.add(sample);
}

std::optional<CameraTurn> Gyroscope::turn(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto motion = samples_.integrate(from_ns, to_ns, {}, {config_.noise_rad_s_rthz, 0});
  if (!motion) return std::nullopt;
  const Eigen::Matrix3d by_bias = motion->bias_jacobian().topLeftCorner<3, 3>();
  const double scale_rad = config_.scale_error * geometry::so3_log(motion->rotation()).norm();
  const Eigen::Matrix3d covariance = motion->covariance().topLeftCorner<3, 3>() +
                                     std::pow(config_.bias_rad_s, 2) * by_bias * by_bias.transpose() +
                                     scale_rad * scale_rad * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d& R = config_.R_camera_imu;
  return CameraTurn{R * motion->rotation() * R.transpose(), R * covariance * R.transpose()};
}

}  // namespace rtd::filter
