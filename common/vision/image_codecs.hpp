// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace rtd::vision {

/// cv::imread, imwrite, imdecode and imencode, with their flags, results and exceptions. Thread-safe.
struct ImageCodecs {
  cv::Mat (*read)(const std::string& file, int flags);
  bool (*write)(const std::string& file, const cv::Mat& image, const std::vector<int>& parameters);
  cv::Mat (*decode)(cv::InputArray bytes, int flags);
  bool (*encode)(const std::string& extension, const cv::Mat& image, std::vector<std::uint8_t>& bytes,
                 const std::vector<int>& parameters);
};

/// OpenCV's image formats come with a hundred libraries, and a service that starts anew should not wait for them. So
/// they are in librtd_image_codecs.so, which lies beside the programs or in ../lib/rtd-slam and is loaded with the
/// first call. Throws std::runtime_error when it is missing or of another version. Thread-safe.
const ImageCodecs& image_codecs();

/// What the library exports; the number changes with ImageCodecs.
inline constexpr const char* kImageCodecsEntry = "rtd_image_codecs_1";

}  // namespace rtd::vision
