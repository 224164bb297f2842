// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "common/geometry/camera_model.hpp"

namespace rtd::msg {
struct FrameView;
}

namespace rtd::vision {

/// One RGB-D image pair in memory, as the cores see it.
struct RgbdImage {
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  cv::Mat color_bgr;           ///< CV_8UC3, the camera's own (distorted) image
  cv::Mat depth;               ///< CV_16UC1, registered to colour, 0 = no measurement
  double depth_scale_m = 0.0;  ///< metres of one depth unit
  geometry::CameraModel camera;
  double readout_s = 0;       ///< of the colour image's rolling shutter, first row to last, s; 0 = none or unknown
  double depth_offset_s = 0;  ///< time of the depth image minus that of the colour image, s; 0 = same or unknown
};

/// Why a frame cannot be used (size, intrinsics, depth scale or times out of bounds); empty when it can.
std::string defect(const msg::FrameView& frame);

/// The images of a message without copying: the memory of `frame` must outlive the result, which must not be written
/// to. The frame has no defect().
RgbdImage view_image(const msg::FrameView& frame);

/// The colour image alone; empty when its size is out of bounds. Otherwise as view_image().
cv::Mat view_color(const msg::FrameView& frame);

}  // namespace rtd::vision
