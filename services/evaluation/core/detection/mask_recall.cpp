// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/detection/mask_recall.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rtd::eval {
namespace {

double share_of(std::size_t part, std::size_t whole) {
  return whole == 0 ? 1 : static_cast<double>(part) / static_cast<double>(whole);
}

constexpr std::size_t kMinPerson_px = 400;
constexpr double kFoundShare = 0.5, kBesideShare = 0.05;

std::size_t count(const cv::Mat& mask) {
  return static_cast<std::size_t>(cv::countNonZero(mask));
}

cv::Rect pixels_of(const vision::Detection& box, cv::Size image) {
  const cv::Point corner(cvRound(box.x_px), cvRound(box.y_px));
  const cv::Point opposite(cvRound(box.x_px + box.width_px), cvRound(box.y_px + box.height_px));
  return cv::Rect(corner, opposite) & cv::Rect({0, 0}, image);
}

void count_people(const cv::Mat& marked, const cv::Mat& covered, MaskRecall& recall) {
  cv::Mat labels, stats, centroids;
  const int areas = cv::connectedComponentsWithStats(marked, labels, stats, centroids);
  for (int i = 1; i < areas; ++i) {
    const auto area_px = static_cast<std::size_t>(stats.at<int>(i, cv::CC_STAT_AREA));
    if (area_px < kMinPerson_px) continue;
    ++recall.people;
    if (static_cast<double>(count((labels == i) & covered)) >= kFoundShare * static_cast<double>(area_px)) {
      ++recall.people_found;
    }
  }
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

MaskOverlap measure_mask_overlap(const cv::Mat& mask, const std::vector<vision::Detection>& boxes,
                                 const vision::PersonMasks& labels, MaskOverlap sum) {
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
  sum.boxed_px += count(boxed);
  sum.marked_px += count(marked);
  sum.labelled_px += count(labelled);
  sum.common_px += count(marked & labelled);
  return sum;
}

double MaskRecall::pixel_recall() const {
  return share_of(covered_pixels, pixels);
}

double MaskRecall::image_share() const {
  return share_of(images_complete, images);
}

MaskRecall measure_mask_recall(const cv::Mat& mask, const std::vector<vision::Detection>& boxes, MaskRecall sum) {
  const cv::Mat marked = mask != 0;
  cv::Mat boxed = cv::Mat::zeros(mask.size(), CV_8UC1);
  const std::size_t missed_before = sum.people - sum.people_found;
  ++sum.images;
  for (const vision::Detection& box : boxes) {
    const cv::Rect area = pixels_of(box, mask.size());
    if (area.empty()) continue;
    boxed(area).setTo(255);
    ++sum.boxes;
    if (static_cast<double>(count(marked(area))) < kBesideShare * area.area()) ++sum.boxes_beside;
  }
  sum.pixels += count(marked);
  sum.covered_pixels += count(marked & boxed);
  count_people(marked, marked & boxed, sum);
  if (sum.people - sum.people_found == missed_before) ++sum.images_complete;
  return sum;
}

}  // namespace rtd::eval
