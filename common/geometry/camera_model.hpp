// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace rtd::geometry {

/// How a lens bends the pinhole image; the values are those of the wire.
enum class Lens : std::uint32_t {
  kBrownConrady = 0,  ///< k1 k2 p1 p2 k3 (k4 k5 k6: OpenCV's rational model)
  kFisheye = 1,       ///< k1 k2 k3 k4 of the equidistant model (OpenCV's fisheye)
};

/// Pinhole camera with the distortion of its lens. Camera frame: optical (x right, y down, z forward).
/// Source: docs/theory/camera.md, Eq. (1)-(3). Immutable value, thread-safe.
class CameraModel {
 public:
  struct Parameters {
    double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px
    std::array<double, 8> distortion{};     ///< coefficients as listed for each Lens, the rest zero
    int width = 0, height = 0;              ///< px
    Lens lens = Lens::kBrownConrady;
    bool operator==(const Parameters&) const = default;
  };

  CameraModel() = default;
  explicit CameraModel(const Parameters& parameters);

  const Parameters& parameters() const { return parameters_; }
  bool distorted() const { return distorted_; }

  /// p_camera (m) -> undistorted pixel. The caller has checked z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const {
    return {parameters_.fx * p_camera.x() / p_camera.z() + parameters_.cx,
            parameters_.fy * p_camera.y() / p_camera.z() + parameters_.cy};
  }
  /// Undistorted pixel and depth along z (m) -> p_camera (m).
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel, double depth_m) const {
    return {(pixel.x() - parameters_.cx) / parameters_.fx * depth_m,
            (pixel.y() - parameters_.cy) / parameters_.fy * depth_m, depth_m};
  }
  /// Pixel of the camera's own image -> pixel of the ideal pinhole image (Newton on Eq. (2)). What a fisheye lens sees
  /// farther off the axis than kWidestView_rad comes to lie at that angle.
  Eigen::Vector2d undistort(const Eigen::Vector2d& raw_pixel) const;
  /// Pixel of the ideal pinhole image -> pixel of the camera's own image, Eq. (2). Both stay within 10^6 px.
  Eigen::Vector2d distort(const Eigen::Vector2d& pixel) const;
  /// Inside the image, `margin_px` away from its border.
  bool contains(const Eigen::Vector2d& pixel, double margin_px = 0.0) const {
    return pixel.x() >= margin_px && pixel.y() >= margin_px && pixel.x() < parameters_.width - margin_px &&
           pixel.y() < parameters_.height - margin_px;
  }

  /// 80 degrees: beyond it a pinhole image would be of no use.
  static constexpr double kWidestView_rad = 1.4;

 private:
  Eigen::Vector2d distort_normalized(const Eigen::Vector2d& n) const;
  double fisheye_radius(double angle_rad) const;
  Eigen::Vector2d undistort_fisheye(const Eigen::Vector2d& target) const;
  Parameters parameters_;
  bool distorted_ = false;
};

/// Standard deviation of a structured-light depth camera, sigma(z) = offset + factor * z^2.
/// Khoshelham & Elberink 2012: random error of the Kinect grows with the square of depth, about 1.5 mm at 1 m.
struct DepthNoise {
  double offset_m = 0.001;
  double factor_per_m = 0.0015;
  double sigma_m(double depth_m) const { return offset_m + factor_per_m * depth_m * depth_m; }
};

}  // namespace rtd::geometry
