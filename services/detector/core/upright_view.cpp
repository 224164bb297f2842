// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/upright_view.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "services/detector/core/letterbox.hpp"

namespace rtd::detector {
namespace {

constexpr int kGrey = 114;  // what the YOLOv5 family was trained with

/// Maps pixel indices of the frame to those of the input; pixel i covers i .. i + 1.
cv::Matx23d to_input(const UprightView& view) {
  const double c = view.scale * view.cos, s = view.scale * view.sin;
  const double from_x = 0.5 - 0.5 * view.frame.width, from_y = 0.5 - 0.5 * view.frame.height;
  const double to_x = 0.5 * view.input.width_px - 0.5, to_y = 0.5 * view.input.height_px - 0.5;
  return {c, -s, c * from_x - s * from_y + to_x, s, c, s * from_x + c * from_y + to_y};
}

}  // namespace

UprightView fit_upright(cv::Size frame, InputSize input, double roll_rad) {
  UprightView view{std::cos(roll_rad), std::sin(roll_rad), 1, frame, input};
  const double c = std::abs(view.cos), s = std::abs(view.sin);
  const double hull_width_px = c * frame.width + s * frame.height, hull_height_px = s * frame.width + c * frame.height;
  view.scale = std::min(input.width_px / hull_width_px, input.height_px / hull_height_px);
  return view;
}

void fill_upright_blob(const cv::Mat& color_bgr, const UprightView& view, cv::Mat& blob) {
  const cv::Size size(view.input.width_px, view.input.height_px);
  cv::Mat upright;
  cv::warpAffine(color_bgr, upright, to_input(view), size, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                 cv::Scalar::all(kGrey));
  fill_blob(upright, fit_letterbox(size, view.input), view.input, blob);
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
