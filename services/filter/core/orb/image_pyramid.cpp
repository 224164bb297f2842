// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/image_pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rtd::filter {

void ImagePyramid::build(const cv::Mat& image) {
  if (image.channels() == 3) {
    cv::cvtColor(image, images_[0], cv::COLOR_BGR2GRAY);
  } else {
    image.copyTo(images_[0]);
  }
  double scale = 1.0;
  for (std::size_t level = 1; level < images_.size(); ++level) {
    scale *= scale_factor_;
    const cv::Size size(std::max(1, static_cast<int>(std::lround(image.cols / scale))),
                        std::max(1, static_cast<int>(std::lround(image.rows / scale))));
    cv::resize(images_[level - 1], images_[level], size, 0, 0, cv::INTER_LINEAR);
  }
}

cv::Point2f ImagePyramid::to_base(cv::Point2f pixel, int level) const {
  const cv::Mat& from = image(level);
  const float scale_x = static_cast<float>(images_[0].cols) / static_cast<float>(from.cols);
  const float scale_y = static_cast<float>(images_[0].rows) / static_cast<float>(from.rows);
  return {(pixel.x + 0.5F) * scale_x - 0.5F, (pixel.y + 0.5F) * scale_y - 0.5F};
}

}  // namespace rtd::filter
