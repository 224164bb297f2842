// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/cell_masks.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace rtd::filter {
namespace {

const GridShape kSmallShape{10, 8};

CellMask rectangle(int left, int top, int width, int height, std::uint8_t value = 1) {
  CellMask mask(static_cast<std::size_t>(kSmallShape.size()), 0);
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) mask[static_cast<std::size_t>(kSmallShape.index(x, y))] = value;
  }
  return mask;
}
auto set_cells(const CellMask& mask) {
  return std::count_if(mask.begin(), mask.end(), [](int v) { return v > 0; });
}

TEST(CellMasks, dilate_grows_by_the_radius_and_stops_at_the_border) {
  EXPECT_EQ(dilate(kSmallShape, rectangle(3, 3, 2, 2, 7), 1), rectangle(2, 2, 4, 4, 7));
  EXPECT_EQ(dilate(kSmallShape, rectangle(0, 0, 1, 1), 2), rectangle(0, 0, 3, 3));
  EXPECT_EQ(dilate(kSmallShape, rectangle(3, 3, 2, 2), 0), rectangle(3, 3, 2, 2));
}

TEST(CellMasks, compact_clears_lines_and_keeps_areas) {
  EXPECT_EQ(set_cells(compact(kSmallShape, rectangle(0, 3, 10, 1))), 0) << "a line one cell wide";
  EXPECT_EQ(set_cells(compact(kSmallShape, rectangle(2, 2, 5, 4))), 5 * 4 - 4) << "an area loses its corners";
}

TEST(CellMasks, keep_regions_asks_for_each_connected_region) {
  CellMask mask = rectangle(0, 0, 2, 2);
  const CellMask large = rectangle(5, 2, 4, 4);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = std::max(mask[i], large[i]);
  std::vector<std::size_t> sizes;
  const CellMask kept = keep_regions(kSmallShape, mask, [&](const std::vector<int>& region) {
    sizes.push_back(region.size());
    return region.size() > 10;
  });
  EXPECT_EQ(sizes, (std::vector<std::size_t>{4, 16}));
  EXPECT_EQ(kept, large);
}

}  // namespace
}  // namespace rtd::filter
