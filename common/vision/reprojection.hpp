// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace rtd::vision {

/// What the residuals of an RGB-D observation need to know of the camera. Undistorted pixels.
struct RgbdProjection {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px
  /// Weight b of the inverse-depth residual, px*m: a disparity b/z is as exact as a pixel coordinate. A stereo pair has
  /// baseline * fx; a structured-light camera reaches several hundred (docs/theory/camera.md, Eq. (6)).
  double disparity_px_m = 40.0;
};

/// One measurement of a point: undistorted pixel and depth along z, 0 = depth not measured.
struct RgbdMeasurement {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double depth_m = 0.0;
  bool has_depth() const { return depth_m > 0.0; }
  int dimension() const { return has_depth() ? 3 : 2; }
};

/// Points nearer than this to the image plane have no usable projection.
inline constexpr double kMinProjectionDepth_m = 1e-2;

/// Predicted minus measured, px: [u, v, b/z - b/depth]; the third is zero without depth. Docs: theory/camera.md Eq.
/// (5). The caller has checked p_camera.z() >= kMinProjectionDepth_m.
inline Eigen::Vector3d rgbd_residual(const RgbdProjection& camera, const Eigen::Vector3d& p_camera,
                                     const RgbdMeasurement& measured) {
  const double inverse_z = 1.0 / p_camera.z();
  return {camera.fx * p_camera.x() * inverse_z + camera.cx - measured.pixel.x(),
          camera.fy * p_camera.y() * inverse_z + camera.cy - measured.pixel.y(),
          measured.has_depth() ? camera.disparity_px_m * (inverse_z - 1.0 / measured.depth_m) : 0.0};
}

/// Derivative of rgbd_residual with respect to p_camera, docs/theory/camera.md Eq. (7).
inline Eigen::Matrix3d rgbd_jacobian(const RgbdProjection& camera, const Eigen::Vector3d& p_camera,
                                     const RgbdMeasurement& measured) {
  const double inverse_z = 1.0 / p_camera.z(), inverse_z2 = inverse_z * inverse_z;
  Eigen::Matrix3d jacobian;
  jacobian << camera.fx * inverse_z, 0, -camera.fx * p_camera.x() * inverse_z2,  //
      0, camera.fy * inverse_z, -camera.fy * p_camera.y() * inverse_z2,          //
      0, 0, measured.has_depth() ? -camera.disparity_px_m * inverse_z2 : 0.0;
  return jacobian;
}

}  // namespace rtd::vision
