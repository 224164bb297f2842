// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"

namespace rtd::vision {

/// Moves depth images from the raster of the depth camera into that of the colour camera, of any sizes.
///
/// Every depth pixel paints the quad that it covers in the colour image: halfway to those of its four neighbours that
/// lie on the same surface, so that neither scaling up nor a slope leaves cracks, and as wide as a pixel seen from
/// there where the surface ends, so that nothing is smeared across an edge. Within the quad the depth follows the slope
/// of the surface; of several surfaces at a pixel the nearest is kept. A pixel belongs to the quads that contain its
/// centre. The lenses may be any of geometry::Lens; the rays of the depth image are computed once. Camera frames are optical.
/// Immutable, thread-safe. Timing: tests/bench/camera/bench_registration.cpp.
class DepthRegistration {
 public:
  /// `color`, `depth`: with their sizes, px. T_color_depth: p_color = T_color_depth * p_depth, m. `depth_scale_m`:
  /// metres of one unit of the depth images, before and after. Throws std::invalid_argument for a camera without size
  /// or focal length, a transform that is not finite, a unit that is not positive.
  DepthRegistration(const geometry::CameraModel& color, const geometry::CameraModel& depth,
                    const Eigen::Isometry3d& T_color_depth, double depth_scale_m);

  /// CV_16UC1 as the depth camera sees it -> CV_16UC1 as the colour camera sees it, depth along its own axis. 0 and
  /// 65535 are no measurement before, 0 is after. Throws std::invalid_argument for another size or type.
  cv::Mat operator()(const cv::Mat& depth) const;

  cv::Size depth_size() const { return {depth_columns_, depth_rows_}; }
  cv::Size color_size() const { return {color_.width, color_.height}; }

 private:
  struct Kernels;

  geometry::CameraModel::Parameters color_;
  bool distorted_;  ///< colour
  int depth_columns_, depth_rows_;
  float farthest_squared_;                  ///< from colour's axis, normalised: beyond, its lens model may fold back
  float scale_m_;                           ///< of a depth unit
  float slope_;                             ///< of a surface between two pixels, at most, relative to its depth
  std::array<std::vector<float>, 3> rays_;  ///< x, y, z of R_color_depth * ray of each depth pixel with z = 1 m
  Eigen::Vector3f t_color_depth_;           ///< m
  Eigen::Vector2f right_px_, down_px_;      ///< step to the next depth pixel, in colour, as far from both cameras
};

}  // namespace rtd::vision
