// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/detection/mask_overlap.hpp"

#include <cmath>

namespace rtd::eval {
namespace {

double share_of(std::size_t part, std::size_t whole) {
  return whole == 0 ? 1 : static_cast<double>(part) / static_cast<double>(whole);
}

std::size_t pixels_in(const cv::Mat& mask) {
  return static_cast<std::size_t>(cv::countNonZero(mask));
}

}  // namespace

double MaskOverlap::iou() const {
  return share_of(common_px, marked_px + labelled_px - common_px);
}

double MaskOverlap::precision() const {
  return share_of(common_px, labelled_px);
}

double MaskOverlap::recall() const {
  return share_of(common_px, marked_px);
}

double MaskOverlap::box_precision() const {
  return share_of(marked_px, boxed_px);
}

MaskOverlap& MaskOverlap::operator+=(const MaskOverlap& other) {
  boxed_px += other.boxed_px;
  marked_px += other.marked_px;
  labelled_px += other.labelled_px;
  common_px += other.common_px;
  return *this;
}

MaskOverlap measure_mask_overlap(const cv::Mat& mask, const std::vector<vision::Detection>& boxes,
                                 const vision::PersonMasks& labels) {
  cv::Mat boxed = cv::Mat::zeros(mask.size(), CV_8UC1), labelled = boxed.clone();
  for (const vision::Detection& box : boxes) {
    const cv::Point corner(static_cast<int>(std::floor(box.x_px)), static_cast<int>(std::floor(box.y_px)));
    const cv::Point opposite(static_cast<int>(std::ceil(box.x_px + box.width_px)),
                             static_cast<int>(std::ceil(box.y_px + box.height_px)));
    boxed(cv::Rect(corner, opposite) & cv::Rect({0, 0}, mask.size())).setTo(255);
  }
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column)
      if (labels.at(column / vision::kMaskStepPx, row / vision::kMaskStepPx) != 0)
        labelled.at<uchar>(row, column) = 255;
  const cv::Mat marked = (mask != 0) & boxed;
  labelled &= boxed;
  return {pixels_in(boxed), pixels_in(marked), pixels_in(labelled), pixels_in(marked & labelled)};
}

}  // namespace rtd::eval
