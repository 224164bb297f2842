// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "common/geometry/camera_model.hpp"

namespace rtd::vision {

/// One RGB-D image pair in memory, as the cores see it.
struct RgbdImage {
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  cv::Mat color_bgr;            ///< CV_8UC3, the camera's own (distorted) image
  cv::Mat depth;                ///< CV_16UC1, registered to colour, 0 = no measurement
  double depth_scale_m = 0.0;   ///< metres of one depth unit
  geometry::CameraModel camera;
};

}  // namespace rtd::vision
