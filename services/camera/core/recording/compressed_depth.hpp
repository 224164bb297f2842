// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "common/msg/ros.hpp"
#include "services/camera/core/image_files.hpp"

namespace rtd::camera {

inline constexpr double kMillimetre = 0.001;  ///< the unit of 16-bit depth in ROS (REP 118)
inline constexpr double kFloatDepthUnitM =
    1.0 / 5000.0;  ///< TUM's: floats are rounded to it unless the recording says more

/// CV_32FC1 metres -> CV_16UC1 in units of unit_m; NaN, infinity, negative and what does not fit become 0.
cv::Mat quantize_depth(const cv::Mat& depth_m, double unit_m);

/// Whether a compressed image comes from ROS's compressed_depth_image_transport.
bool is_compressed_depth(const msg::CompressedImage& image);

/// Its content: 12 bytes (a format, quantisation parameters a and b), then a 16-bit PNG; of floats the PNG holds
/// a / depth + b (inverse depth). Throws SourceError for its other compression, RVL.
ImageRead decode_compressed_depth(const msg::CompressedImage& image, const std::string& name, double float_unit_m);

}  // namespace rtd::camera
