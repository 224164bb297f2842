// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/vision/image_codecs.hpp"

namespace rtd::vision {

/// As decode_image(), for bytes that begin as a JPEG.
DecodedImage decode_jpeg(std::span<const std::uint8_t> bytes, const DecodeRules& rules);

/// 1 to 8 of the EXIF data (the tag "Orientation" of TIFF 6.0), or 1 where there are none. `app1`: the contents of a
/// JPEG's marker APP1.
int exif_orientation(std::span<const std::uint8_t> app1);

/// The image as it is meant to be looked at.
cv::Mat turn_upright(const cv::Mat& image, int orientation);

}  // namespace rtd::vision
