// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "common/vision/detection.hpp"

namespace rtd::eval {

/// How far the labels of a detector's masks agree with true masks, inside its boxes.
struct MaskOverlap {
  std::size_t boxed_px = 0;                    ///< inside boxes; all others count only those
  std::size_t marked_px = 0, labelled_px = 0;  ///< in the true mask; with a label
  std::size_t common_px = 0;                   ///< both

  double iou() const;            ///< common / (marked or labelled); 1 when there is neither
  double precision() const;      ///< common / labelled; 1 without labels
  double recall() const;         ///< common / marked; 1 when nothing is marked
  double box_precision() const;  ///< marked / boxed: that of boxes alone; 1 without boxes
};

/// Adds one image to `sum`: the true `mask` (CV_8UC1, not 0 = marked) against labels of the same image. Without labels,
/// nothing is labelled.
MaskOverlap measure_mask_overlap(const cv::Mat& mask, const std::vector<vision::Detection>& boxes,
                                 const vision::PersonMasks& labels, MaskOverlap sum = {});

/// How much of what a mask marks lies in boxes.
struct MaskRecall {
  std::size_t images = 0, images_complete = 0;  ///< complete: every person in it found
  std::size_t pixels = 0, covered_pixels = 0;   ///< marked; marked and inside a box
  std::size_t people = 0, people_found = 0;     ///< connected marked areas of 400 px or more; half of it inside boxes
  std::size_t boxes = 0, boxes_beside = 0;      ///< beside: less than 5 % of the box is marked (posters of people)

  double pixel_recall() const;  ///< 1 when nothing is marked
  double image_share() const;   ///< images_complete / images
};

/// Adds one image to `sum`: `mask` (CV_8UC1, not 0 = marked) against boxes in the same pixels.
MaskRecall measure_mask_recall(const cv::Mat& mask, const std::vector<vision::Detection>& boxes, MaskRecall sum = {});

}  // namespace rtd::eval
