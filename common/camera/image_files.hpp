// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// An image read from a file, or why there is none.
struct ImageRead {
  cv::Mat image;
  std::optional<SkippedInput> problem;
  std::string remark = {};  ///< what is wrong with a message that can be used all the same; empty when nothing is
};

/// PNG, JPEG or PPM as CV_8UC3 BGR. A file that ends early is refused (decoders would fill the rest with grey), and so
/// is one that leads out of the folder `below` (io::open_regular; empty: it may).
ImageRead read_color(const std::filesystem::path& file, const std::filesystem::path& below = {});

/// Depth in one of kDepthFormats (depth_formats.hpp) as CV_16UC1, or as CV_32FC1 in the file's own unit. 65535
/// (saturated) of 16 bits becomes 0, "no measurement". Other pixel types are refused by name.
ImageRead read_depth(const std::filesystem::path& file, const std::filesystem::path& below = {});

/// PNG or JPEG, and 16-bit PNG, from memory; `name` is for messages.
ImageRead decode_color(std::span<const std::uint8_t> encoded, const std::string& name);
ImageRead decode_depth(std::span<const std::uint8_t> encoded, const std::string& name);

/// CV_32FC1 -> CV_16UC1 in units of `step`, which is in the unit of the values; NaN, infinity, negative and what does
/// not fit become 0.
cv::Mat quantize_depth(const cv::Mat& values, double step);

/// 65535 -> 0 in a CV_16UC1 image.
void drop_saturated(cv::Mat& depth);

}  // namespace rtd::camera
