// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/network_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace rtd::detector {
namespace {

constexpr int kGreyLevel = 114;  // what YOLOv5 and YOLOX were trained with

/// The grey around the frame.
void fill_grey(InputSize input, const PixelFormat& pixels, float* blob) {
  const std::size_t plane = static_cast<std::size_t>(input.width_px) * static_cast<std::size_t>(input.height_px);
  for (std::size_t c = 0; c < pixels.scale.size(); ++c)
    std::fill_n(blob + c * plane, plane, (kGreyLevel - pixels.offset[c]) * pixels.scale[c]);
}

void split_channels(const cv::Mat& color_bgr, const Letterbox& letterbox, InputSize input, const PixelFormat& pixels,
                    float* blob) {
  const std::size_t plane = static_cast<std::size_t>(input.width_px) * static_cast<std::size_t>(input.height_px);
  for (int row = 0; row < color_bgr.rows; ++row) {
    const std::uint8_t* const bgr = color_bgr.ptr<std::uint8_t>(row);
    const auto offset =
        static_cast<std::size_t>(row + letterbox.pad_top_px) * static_cast<std::size_t>(input.width_px) +
        static_cast<std::size_t>(letterbox.pad_left_px);
    for (std::size_t c = 0; c < pixels.scale.size(); ++c) {
      const std::uint8_t* const from = bgr + (pixels.rgb ? 2 - c : c);
      float* const to = blob + c * plane + offset;
      const float minus = pixels.offset[c], scale = pixels.scale[c];
      for (int col = 0; col < color_bgr.cols; ++col) to[col] = (static_cast<float>(from[3 * col]) - minus) * scale;
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

void fill_blob(const cv::Mat& color_bgr, const Letterbox& letterbox, InputSize input, const PixelFormat& pixels,
               cv::Mat& blob) {
  const std::array<int, 4> shape = {1, 3, input.height_px, input.width_px};
  blob.create(static_cast<int>(shape.size()), shape.data(), CV_32F);
  const cv::Size scaled_size(letterbox.width_px, letterbox.height_px);
  if (scaled_size != cv::Size(input.width_px, input.height_px)) fill_grey(input, pixels, blob.ptr<float>());
  cv::Mat scaled = color_bgr;
  if (color_bgr.size() != scaled_size) cv::resize(color_bgr, scaled, scaled_size, 0, 0, cv::INTER_LINEAR);
  split_channels(scaled, letterbox, input, pixels, blob.ptr<float>());
}

cv::Rect2f box_in_frame(const Candidate& candidate, const Letterbox& letterbox, cv::Size frame) {
  const auto to_x_px = [&](float x_px) {
    return static_cast<float>(std::clamp((x_px - letterbox.pad_left_px) / letterbox.scale_x, 0.0, double(frame.width)));
  };
  const auto to_y_px = [&](float y_px) {
    return static_cast<float>(std::clamp((y_px - letterbox.pad_top_px) / letterbox.scale_y, 0.0, double(frame.height)));
  };
  const float left_px = to_x_px(candidate.left_px), top_px = to_y_px(candidate.top_px);
  return {left_px, top_px, to_x_px(candidate.right_px) - left_px, to_y_px(candidate.bottom_px) - top_px};
}

}  // namespace rtd::detector
