// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/depth_colors.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rtd::camera {

cv::Mat depth_colors(const cv::Mat& depth, double nearest, double farthest) {
  const double range = std::max(1.0, farthest - nearest);
  cv::Mat grey, colors;
  depth.convertTo(grey, CV_8UC1, -255 / range, 255 * farthest / range);
  cv::applyColorMap(grey, colors, cv::COLORMAP_JET);
  colors.setTo(cv::Scalar::all(0), depth == 0);
  return colors;
}

cv::Mat depth_preview(const cv::Mat& depth, double depth_scale_m) {
  constexpr int kWidest_px = 320;
  if (depth.empty() || !(depth_scale_m > 0)) return {};
  const int step = (depth.cols + kWidest_px - 1) / kWidest_px;
  cv::Mat small;  // pixels as they are: between a near and a far one lies no surface
  cv::resize(depth, small, {depth.cols / step, std::max(1, depth.rows / step)}, 0, 0, cv::INTER_NEAREST);
  return depth_colors(small, kPreviewNear_m / depth_scale_m, kPreviewFar_m / depth_scale_m);
}

}  // namespace rtd::camera
