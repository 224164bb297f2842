// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/rolling_shutter.hpp"

namespace rtd::slam {

double row_time(double v_px, int height_px) {
  return v_px / height_px - 0.5;
}

Eigen::Vector3d drift_of(const Eigen::Vector3d& p_camera, const geometry::Vector6d& velocity_per_s) {
  return velocity_per_s.head<3>() + velocity_per_s.tail<3>().cross(p_camera);
}

msg::Feature undo_rolling_shutter(const msg::Feature& feature, const vision::RgbdProjection& camera, int height_px,
                                  const ShutterMotion& motion) {
  constexpr double kMinDepth_m = 0.05;
  const double shift_s = row_time(feature.v_px, height_px) * motion.readout_s;
  const bool deep = feature.depth_m > 0;
  const Eigen::Vector3d ray((feature.u_px - camera.cx) / camera.fx, (feature.v_px - camera.cy) / camera.fy, 1);
  geometry::Vector6d velocity = motion.velocity_per_s;
  if (!deep) velocity.head<3>().setZero();
  const Eigen::Vector3d p = deep ? Eigen::Vector3d(feature.depth_m * ray) : ray;
  const Eigen::Vector3d q = p + shift_s * drift_of(p, velocity);
  if (!(q.z() > kMinDepth_m)) return feature;
  msg::Feature moved = feature;
  moved.u_px = static_cast<float>(camera.fx * q.x() / q.z() + camera.cx);
  moved.v_px = static_cast<float>(camera.fy * q.y() / q.z() + camera.cy);
  if (deep) moved.depth_m = static_cast<float>(q.z());
  return moved;
}

}  // namespace rtd::slam
