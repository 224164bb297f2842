// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/detection/mask_recall.hpp"

#include <gtest/gtest.h>

namespace rtd::eval {
namespace {

/// Labels of an image of 40 x 40 px with 1 in these places, a rectangle of the grid.
vision::PersonMasks labels_in(const cv::Rect& places) {
  vision::PersonMasks masks{10, 10, std::vector<std::uint8_t>(100, 0)};
  for (int row = places.y; row < places.br().y; ++row)
    for (int column = places.x; column < places.br().x; ++column) masks.labels[std::size_t(10 * row + column)] = 1;
  return masks;
}

cv::Mat mask_of(const cv::Rect& marked) {
  cv::Mat mask = cv::Mat::zeros(40, 40, CV_8UC1);
  mask(marked).setTo(1);
  return mask;
}

const std::vector<vision::Detection> kBox = {{"person", 1, 0, 0, 20, 40}};

TEST(MaskOverlap, counts_pixels_inside_boxes_only) {
  const MaskOverlap overlap = measure_mask_overlap(mask_of({0, 0, 40, 20}), kBox, labels_in({0, 0, 10, 10}));
  EXPECT_EQ(overlap.boxed_px, 800U);
  EXPECT_EQ(overlap.marked_px, 400U);
  EXPECT_EQ(overlap.labelled_px, 800U);
  EXPECT_DOUBLE_EQ(overlap.iou(), 0.5);
  EXPECT_DOUBLE_EQ(overlap.precision(), 0.5);
  EXPECT_DOUBLE_EQ(overlap.recall(), 1);
  EXPECT_DOUBLE_EQ(overlap.box_precision(), 0.5);
}

TEST(MaskOverlap, is_nothing_without_labels_and_all_without_anything) {
  EXPECT_DOUBLE_EQ(measure_mask_overlap(mask_of({0, 0, 40, 20}), kBox, {}).iou(), 0);
  EXPECT_DOUBLE_EQ(measure_mask_overlap(mask_of({0, 0, 40, 20}), {}, {}).iou(), 1);
}

TEST(MaskOverlap, sums_up_over_images) {
  MaskOverlap sum = measure_mask_overlap(mask_of({0, 0, 20, 40}), kBox, labels_in({0, 0, 5, 10}));
  sum += measure_mask_overlap(mask_of({0, 0, 20, 40}), kBox, {});
  EXPECT_DOUBLE_EQ(sum.iou(), 0.5);
  EXPECT_DOUBLE_EQ(sum.precision(), 1);
}

}  // namespace
}  // namespace rtd::eval
