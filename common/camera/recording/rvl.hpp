// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::camera {

inline constexpr std::uint64_t kMaxRecordedPixels = 1U << 24;  ///< a run of zeros costs nothing: memory needs a limit

/// A depth image in RVL (Wilson, "Fast Lossless Depth Image Compression", ISS 2017), as ROS's compressedDepth writes
/// it: width and height as 32-bit numbers, then runs of zeros and of differences to the pixel before, as numbers of
/// variable length: 3 bits in a nibble, lowest first, its top bit set when more follow; eight nibbles, highest first,
/// in a 32-bit little-endian word. Gives CV_16UC1. Never reads outside the bytes; throws ros::WireError for an image of
/// no or more than 2^24 pixels, runs beyond its end, numbers too long and bytes that end early.
cv::Mat decode_rvl(ros::Bytes bytes);

}  // namespace rtd::camera
