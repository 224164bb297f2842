// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "common/camera/synthetic/renderer.hpp"
#include "common/geometry/camera_model.hpp"

namespace rtd::camera::synthetic {

/// Bends what a pinhole camera sees into the image of a camera with distortion: one table for colour (bilinear), depth,
/// mask, material and objects (nearest). Immutable.
class Lens {
 public:
  explicit Lens(const geometry::CameraModel& camera);

  /// Sees all that the lens shows. The same as the camera when that has no distortion.
  const geometry::CameraModel& pinhole() const { return pinhole_; }
  /// What `rendering`, made by the pinhole camera, becomes; without distortion `rendering` itself.
  Rendering bent(const Rendering& rendering) const;

 private:
  geometry::CameraModel pinhole_;
  cv::Mat from_u_, from_v_;  ///< CV_32FC1, px of the pinhole image; empty without distortion
};

/// The objects that an image shows, by index. `object` and `moving_mask`: as in Rendering.
std::vector<ObjectView> find_objects(const cv::Mat& object, const cv::Mat& moving_mask);

}  // namespace rtd::camera::synthetic
