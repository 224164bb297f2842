// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"

namespace rtd::test {

/// Planes, whole or cut to a rectangle, in the frame of a depth camera: depth images of it in double.
class BoxScene {
 public:
  struct Plane {
    Eigen::Vector3d normal;
    double offset_m = 0;                              ///< normal * p = offset
    Eigen::Vector2d low{-1e3, -1e3}, high{1e3, 1e3};  ///< of x and y, m
  };
  explicit BoxScene(std::vector<Plane> planes) : planes_(std::move(planes)) {}

  /// A wall at 2.5 m, tilted about both axes, and before it a plate at 1.2 m.
  static BoxScene plate_before_wall() {
    return BoxScene(
        {{Eigen::Vector3d(0.4, -0.25, 1), 2.5}, {Eigen::Vector3d(0, 0, 1), 1.2, {-0.2, -0.15}, {0.25, 0.1}}});
  }

  /// Depth along the camera's axis at a pixel of its own (distorted) image, m; 0 = nothing there.
  double depth_m(const geometry::CameraModel& camera, const Eigen::Isometry3d& T_scene_camera,
                 const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d ray = camera.unproject(camera.undistort(pixel), 1.0);
    const Eigen::Vector3d from = T_scene_camera.translation(), along = T_scene_camera.linear() * ray;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Plane& plane : planes_) {
      const double z_m = (plane.offset_m - plane.normal.dot(from)) / plane.normal.dot(along);
      const Eigen::Vector2d at = (from + z_m * along).head<2>();
      const bool inside = (at.array() >= plane.low.array()).all() && (at.array() <= plane.high.array()).all();
      if (z_m > 0 && inside) nearest_m = std::min(nearest_m, z_m);
    }
    return std::isfinite(nearest_m) ? nearest_m : 0;
  }

  /// CV_16UC1.
  cv::Mat depth(const geometry::CameraModel& camera, const Eigen::Isometry3d& T_scene_camera, double unit_m) const {
    cv::Mat image(camera.parameters().height, camera.parameters().width, CV_16UC1);
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double units = std::round(depth_m(camera, T_scene_camera, {x, y}) / unit_m);
        image.at<std::uint16_t>(y, x) = units < 65535 ? static_cast<std::uint16_t>(units) : 0;
      }
    }
    return image;
  }

 private:
  std::vector<Plane> planes_;
};

}  // namespace rtd::test
