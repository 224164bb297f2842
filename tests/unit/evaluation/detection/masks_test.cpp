// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "services/evaluation/core/detection/mask_recall.hpp"

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
  sum = measure_mask_overlap(mask_of({0, 0, 20, 40}), kBox, {}, sum);
  EXPECT_DOUBLE_EQ(sum.iou(), 0.5);
  EXPECT_DOUBLE_EQ(sum.precision(), 1);
}

/// Two people of 20 x 40 px and a speck.
cv::Mat two_people() {
  cv::Mat mask = cv::Mat::zeros(100, 200, CV_8UC1);
  mask(cv::Rect(10, 10, 20, 40)).setTo(1);
  mask(cv::Rect(100, 50, 20, 40)).setTo(255);
  mask(cv::Rect(180, 0, 10, 10)).setTo(255);
  return mask;
}

vision::Detection box(float x_px, float y_px, float width_px, float height_px) {
  return {"person", 0.9F, x_px, y_px, width_px, height_px};
}

TEST(MaskRecall, counts_pixels_and_people_as_computed_by_hand) {
  const MaskRecall recall =
      measure_mask_recall(two_people(), {box(10, 10, 20, 30), box(10, 10, 10, 20), box(100, 50, 20, 10)});

  EXPECT_EQ(recall.pixels, 1700U);
  EXPECT_EQ(recall.covered_pixels, 800U);  // overlapping boxes count once
  EXPECT_EQ(recall.people, 2U);            // the speck is not a person
  EXPECT_EQ(recall.people_found, 1U);
  EXPECT_EQ(recall.images_complete, 0U);
  EXPECT_EQ(recall.boxes_beside, 0U);
}

TEST(MaskRecall, counts_boxes_beside_the_mask) {
  const MaskRecall recall = measure_mask_recall(
      two_people(), {box(150, 10, 20, 20), box(-50, -50, 300, 300), box(500, 500, 10, 10), box(0, 0, 0, 0)});
  EXPECT_EQ(recall.boxes, 2U);
  EXPECT_EQ(recall.boxes_beside, 1U);
  EXPECT_EQ(recall.images_complete, 1U);
  EXPECT_DOUBLE_EQ(recall.pixel_recall(), 1);
}

TEST(MaskRecall, adds_up_over_images) {
  MaskRecall sum = measure_mask_recall(two_people(), {});
  sum = measure_mask_recall(two_people(), {box(0, 0, 200, 100)}, sum);
  EXPECT_DOUBLE_EQ(sum.pixel_recall(), 0.5);
  EXPECT_DOUBLE_EQ(sum.image_share(), 0.5);
}

TEST(MaskRecall, is_complete_where_nothing_is_marked) {
  const MaskRecall recall = measure_mask_recall(cv::Mat::zeros(10, 10, CV_8UC1), {});
  EXPECT_DOUBLE_EQ(recall.pixel_recall(), 1);
  EXPECT_EQ(recall.images_complete, 1U);
}

}  // namespace
}  // namespace rtd::eval
