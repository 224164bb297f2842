// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// An image read from a file, or why there is none.
struct ImageRead {
  cv::Mat image;
  std::optional<SkippedInput> problem;
};

/// PNG or JPEG as CV_8UC3 BGR. A file that ends early is refused (decoders would fill the rest with grey).
ImageRead read_color(const std::filesystem::path& file);

/// 16-bit PNG as CV_16UC1. 65535 (saturated) becomes 0, "no measurement". Other pixel types are refused by name.
ImageRead read_depth(const std::filesystem::path& file);

}  // namespace rtd::camera
