// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/letterbox.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace rtd::detector {
namespace {

constexpr float kPixelScale = 1.0F / 255.0F;
constexpr float kGrey = 114.0F * kPixelScale;  // what the YOLOv5 family was trained with

void split_to_rgb(const cv::Mat& color_bgr, const Letterbox& letterbox, InputSize input, float* blob) {
  const std::size_t plane = static_cast<std::size_t>(input.width_px) * static_cast<std::size_t>(input.height_px);
  for (int row = 0; row < color_bgr.rows; ++row) {
    const std::uint8_t* const bgr = color_bgr.ptr<std::uint8_t>(row);
    const auto offset =
        static_cast<std::size_t>(row + letterbox.pad_top_px) * static_cast<std::size_t>(input.width_px) +
        static_cast<std::size_t>(letterbox.pad_left_px);
    float* const red = blob + offset;
    float* const green = red + plane;
    float* const blue = green + plane;
    for (int col = 0; col < color_bgr.cols; ++col) {
      blue[col] = static_cast<float>(bgr[3 * col]) * kPixelScale;
      green[col] = static_cast<float>(bgr[3 * col + 1]) * kPixelScale;
      red[col] = static_cast<float>(bgr[3 * col + 2]) * kPixelScale;
    }
  }
}

}  // namespace

Letterbox fit_letterbox(cv::Size frame, InputSize input) {
  const double scale =
      std::min(static_cast<double>(input.width_px) / frame.width, static_cast<double>(input.height_px) / frame.height);
  Letterbox letterbox;
  letterbox.width_px = std::clamp(static_cast<int>(std::lround(scale * frame.width)), 1, input.width_px);
  letterbox.height_px = std::clamp(static_cast<int>(std::lround(scale * frame.height)), 1, input.height_px);
  letterbox.scale_x = static_cast<double>(letterbox.width_px) / frame.width;
  letterbox.scale_y = static_cast<double>(letterbox.height_px) / frame.height;
  letterbox.pad_left_px = (input.width_px - letterbox.width_px) / 2;
  letterbox.pad_top_px = (input.height_px - letterbox.height_px) / 2;
  return letterbox;
}

void fill_blob(const cv::Mat& color_bgr, const Letterbox& letterbox, InputSize input, cv::Mat& blob) {
  const std::array<int, 4> shape = {1, 3, input.height_px, input.width_px};
  blob.create(static_cast<int>(shape.size()), shape.data(), CV_32F);
  const cv::Size scaled_size(letterbox.width_px, letterbox.height_px);
  if (scaled_size != cv::Size(input.width_px, input.height_px)) blob.setTo(kGrey);
  cv::Mat scaled = color_bgr;
  if (color_bgr.size() != scaled_size) cv::resize(color_bgr, scaled, scaled_size, 0, 0, cv::INTER_LINEAR);
  split_to_rgb(scaled, letterbox, input, blob.ptr<float>());
}

}  // namespace rtd::detector
