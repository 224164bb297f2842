// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgcodecs.hpp>

#include "common/vision/image_codecs.hpp"

/// kImageCodecsEntry.
extern "C" const rtd::vision::ImageCodecs* rtd_image_codecs_1() {
  static constexpr rtd::vision::ImageCodecs kCodecs = {
      .read = [](const std::string& file, int flags) { return cv::imread(file, flags); },
      .write = [](const std::string& file, const cv::Mat& image,
                  const std::vector<int>& parameters) { return cv::imwrite(file, image, parameters); },
      .decode = [](cv::InputArray bytes, int flags) { return cv::imdecode(bytes, flags); },
      .encode = [](const std::string& extension, const cv::Mat& image, std::vector<std::uint8_t>& bytes,
                   const std::vector<int>& parameters) { return cv::imencode(extension, image, bytes, parameters); }};
  return &kCodecs;
}
