// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/cell_masks.hpp"

#include <gtest/gtest.h>

namespace rtd::filter {
namespace {

const vision::Detection kBox{"person", 0.9F, 100, 100, 80, 200};

/// Labels of a 640x480 image: label 2 on the pixels 120..159 x 140..259, label 1 below them.
vision::PersonMasks labels() {
  vision::PersonMasks masks{160, 120, std::vector<std::uint8_t>(160 * 120, 0)};
  for (int row = 35; row < 100; ++row) {
    for (int column = 30; column < 40; ++column)
      masks.labels[static_cast<std::size_t>(row * 160 + column)] = row < 65 ? 2 : 1;
  }
  return masks;
}

TEST(BoxMask, covers_the_pixels_of_its_label) {
  const BoxMask mask(labels(), 2, kBox);
  EXPECT_FALSE(mask.empty());
  EXPECT_TRUE(mask.covers({120, 140}, kBox));
  EXPECT_TRUE(mask.covers({159, 259}, kBox));
  EXPECT_FALSE(mask.covers({119, 140}, kBox));
  EXPECT_FALSE(mask.covers({160, 140}, kBox));
  EXPECT_FALSE(mask.covers({140, 260}, kBox)) << "another label";
}

TEST(BoxMask, moves_and_grows_with_its_box) {
  const BoxMask mask(labels(), 2, kBox);
  const vision::Detection now{"person", 0.9F, 200, 50, 160, 400};  // twice as large
  EXPECT_TRUE(mask.covers({200 + 2 * 21, 50 + 2 * 41}, now));
  EXPECT_TRUE(mask.covers({200 + 2 * 59, 50 + 2 * 159}, now));
  EXPECT_FALSE(mask.covers({200 + 2 * 18, 50 + 2 * 41}, now));
  EXPECT_FALSE(mask.covers({200 + 2 * 62, 50 + 2 * 41}, now));
}

TEST(BoxMask, is_empty_where_no_place_has_its_label) {
  EXPECT_TRUE(BoxMask(labels(), 3, kBox).empty());
  EXPECT_TRUE(BoxMask(labels(), 0, kBox).empty()) << "the label of no detection";
  EXPECT_TRUE(BoxMask({}, 1, kBox).empty());
  EXPECT_FALSE(BoxMask().covers({120, 140}, kBox));
}

TEST(BoxMask, is_empty_when_labels_are_missing) {
  vision::PersonMasks cut = labels();
  cut.labels.pop_back();
  EXPECT_TRUE(BoxMask(cut, 2, kBox).empty());
  cut.columns = -160;
  EXPECT_TRUE(BoxMask(cut, 2, kBox).empty());
}

}  // namespace
}  // namespace rtd::filter
