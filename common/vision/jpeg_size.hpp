// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>

namespace rtd::vision {

/// Width and height in px from the header of a JPEG, without decoding it; 0 x 0 when it is not one.
cv::Size jpeg_size(std::span<const std::uint8_t> bytes);

}  // namespace rtd::vision
