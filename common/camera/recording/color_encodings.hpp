// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace rtd::camera {

/// One of sensor_msgs' image encodings that can be made a colour image.
struct ColorEncoding {
  std::string_view name;
  int type;        ///< OpenCV's, of the pixels as they lie in the message
  int conversion;  ///< OpenCV's, of 8-bit pixels to BGR; negative when they are BGR
  /// Rows of bytes of an image: colour lies below the grey, of nv12 and nv21 in half the size, of nv24 in full size.
  std::uint32_t rows(std::uint32_t height) const {
    if (name == "nv24") return 3 * height;
    return name.starts_with("nv") ? height + height / 2 : height;
  }
};

/// Null when it is not known. Names are those of sensor_msgs/image_encodings.hpp and those that drivers use besides
/// them; the name of a Bayer pattern is its first row and then its second.
const ColorEncoding* find_color_encoding(std::string_view name);

/// "rgb8, bgr8, ...": for messages.
std::string known_color_encodings();

/// Why pixels of this encoding cannot have this size; empty when they can.
std::string size_defect(const ColorEncoding& encoding, cv::Size size_px);

/// CV_8UC3 BGR of pixels of the encoding's type; of values of more than 8 bits (`bits`, 9 to 16; larger values are
/// white) the upper eight are kept. YUV is BT.601 of limited range,
/// as in cv_bridge. The size must have no size_defect().
cv::Mat to_bgr(const ColorEncoding& encoding, const cv::Mat& pixels, int bits = 16);

}  // namespace rtd::camera
