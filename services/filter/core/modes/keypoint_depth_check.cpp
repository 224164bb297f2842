// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/keypoint_depth_check.hpp"

#include <cmath>
#include <numbers>

namespace rtd::filter {
namespace {

constexpr double kMinDepthM = 0.1;

/// Depth at an undistorted pixel, 0 = outside or not measured.
double depth_at_m(const vision::RgbdImage& image, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d raw = image.camera.distort(pixel);
  const long u = std::lround(raw.x()), v = std::lround(raw.y());
  if (u < 0 || v < 0 || u >= image.depth.cols || v >= image.depth.rows) return 0;
  return image.depth.at<std::uint16_t>(static_cast<int>(v), static_cast<int>(u)) * image.depth_scale_m;
}

double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

CellMask check_keypoint_depths(const vision::RgbdImage& image, const GridShape& shape,
                               const Eigen::Isometry3d& T_world_camera, const std::vector<const View*>& keyframes,
                               const PaperConfig& config) {
  const double max_angle_rad = config.max_view_angle_deg * std::numbers::pi / 180;
  CellMask moved(static_cast<std::size_t>(shape.size()), 0);
  for (const View* keyframe : keyframes) {
    const Eigen::Isometry3d T_camera_keyframe = T_world_camera.inverse() * keyframe->T_world_camera;
    for (const msg::Feature& feature : keyframe->features) {
      if (feature.depth_m <= 0) continue;
      const Eigen::Vector3d p_keyframe = image.camera.unproject({feature.u_px, feature.v_px}, feature.depth_m);
      const Eigen::Vector3d p_camera = T_camera_keyframe * p_keyframe;
      if (p_camera.z() < kMinDepthM) continue;
      const Eigen::Vector2d pixel = image.camera.project(p_camera);
      if (!image.camera.contains(pixel)) continue;
      if (angle_rad(T_camera_keyframe.linear() * p_keyframe, p_camera) > max_angle_rad) continue;
      const double measured_m = depth_at_m(image, pixel);
      if (measured_m <= 0 || p_camera.z() - measured_m <= config.tau_m) continue;
      moved[static_cast<std::size_t>(shape.nearest_cell(pixel.x(), pixel.y()))] = 1;
    }
  }
  return dilate(shape, moved, 1);
}

}  // namespace rtd::filter
