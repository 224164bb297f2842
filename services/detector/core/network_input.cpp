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

/// Maps pixel indices of the frame to those of the input; pixel i covers i .. i + 1.
cv::Matx23d to_input(const UprightView& view) {
  const double c = view.scale * view.cos, s = view.scale * view.sin;
  const double from_x = 0.5 - 0.5 * view.frame.width, from_y = 0.5 - 0.5 * view.frame.height;
  const double to_x = 0.5 * view.input.width_px - 0.5, to_y = 0.5 * view.input.height_px - 0.5;
  return {c, -s, c * from_x - s * from_y + to_x, s, c, s * from_x + c * from_y + to_y};
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

UprightView fit_upright(cv::Size frame, InputSize input, double roll_rad) {
  UprightView view{std::cos(roll_rad), std::sin(roll_rad), 1, frame, input};
  const double c = std::abs(view.cos), s = std::abs(view.sin);
  const double hull_width_px = c * frame.width + s * frame.height, hull_height_px = s * frame.width + c * frame.height;
  view.scale = std::min(input.width_px / hull_width_px, input.height_px / hull_height_px);
  return view;
}

void fill_upright_blob(const cv::Mat& color_bgr, const UprightView& view, const PixelFormat& pixels, cv::Mat& blob) {
  const cv::Size size(view.input.width_px, view.input.height_px);
  cv::Mat upright;
  cv::warpAffine(color_bgr, upright, to_input(view), size, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                 cv::Scalar::all(kGreyLevel));
  fill_blob(upright, fit_letterbox(size, view.input), view.input, pixels, blob);
}

cv::Rect2f box_in_frame(const Candidate& candidate, const UprightView& view) {
  const double x = 0.5 * (candidate.left_px + candidate.right_px - view.input.width_px) / view.scale;
  const double y = 0.5 * (candidate.top_px + candidate.bottom_px - view.input.height_px) / view.scale;
  const double a = 0.5 * (candidate.right_px - candidate.left_px) / view.scale;
  const double b = 0.5 * (candidate.bottom_px - candidate.top_px) / view.scale;
  const double centre_x = 0.5 * view.frame.width + view.cos * x + view.sin * y;
  const double centre_y = 0.5 * view.frame.height - view.sin * x + view.cos * y;
  const double half_width = std::hypot(a * view.cos, b * view.sin),
               half_height = std::hypot(a * view.sin, b * view.cos);
  const auto clip = [](double value, int size) { return static_cast<float>(std::clamp(value, 0.0, double(size))); };
  return {cv::Point2f(clip(centre_x - half_width, view.frame.width), clip(centre_y - half_height, view.frame.height)),
          cv::Point2f(clip(centre_x + half_width, view.frame.width), clip(centre_y + half_height, view.frame.height))};
}

}  // namespace rtd::detector
