// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace rtd::filter {

/// Grey images of one frame, each smaller by the scale factor. Buffers are reused from frame to frame.
class ImagePyramid {
 public:
  ImagePyramid(int levels, double scale_factor)
      : scale_factor_(scale_factor), images_(static_cast<std::size_t>(levels)) {}

  /// `image`: CV_8UC3 (BGR) or CV_8UC1.
  void build(const cv::Mat& image);

  int levels() const { return static_cast<int>(images_.size()); }
  const cv::Mat& image(int level) const { return images_[static_cast<std::size_t>(level)]; }
  /// Pixel of a level -> pixel of level 0. Pixel centres map to pixel centres, so no octave is biased against another.
  cv::Point2f to_base(cv::Point2f pixel, int level) const;

 private:
  double scale_factor_;
  std::vector<cv::Mat> images_;
};

}  // namespace rtd::filter
