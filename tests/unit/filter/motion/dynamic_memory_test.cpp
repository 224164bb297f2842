// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/dynamic_regions.hpp"

#include <gtest/gtest.h>

#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::cells_in;
using test::count_in;
using test::kBlock;
using test::kShape;

/// Remembers a block at 1.5 m as dynamic for 20 frames.
class DynamicMemoryTest : public ::testing::Test {
 protected:
  DynamicMemoryTest() {
    const DepthGrid grid = sampler_.sample(block_at(kBlock, 1.5));
    std::vector<std::uint8_t> frames_left(grid.depth_m.size(), 0);
    for (std::size_t i = 0; i < frames_left.size(); ++i) frames_left[i] = grid.depth_m[i] < 2 ? 20 : 0;
    memory_.store(grid, sampler_.rays(), frames_left);
  }
  static vision::RgbdImage block_at(const cv::Rect& area, double depth_m) {
    vision::RgbdImage image = test::wall_image(3.0);
    test::put_block(image, area, depth_m);
    return image;
  }
  std::vector<std::uint8_t> recall(const vision::RgbdImage& image, const Eigen::Isometry3d& T_current_last) {
    return memory_.recall(sampler_.sample(image), image.camera, T_current_last);
  }
  DepthGridSampler sampler_ = test::make_sampler();
  DynamicMemory memory_;
};

TEST_F(DynamicMemoryTest, finds_the_block_again) {
  const auto frames_left = recall(block_at(kBlock, 1.45), Eigen::Isometry3d::Identity());
  EXPECT_EQ(count_in(kShape, frames_left, kBlock), cells_in(kBlock));
  EXPECT_EQ(frames_left[static_cast<std::size_t>(kShape.cell_at(300, 240))], 20);
}

TEST_F(DynamicMemoryTest, follows_the_motion_of_the_camera) {
  Eigen::Isometry3d T_current_last = Eigen::Isometry3d::Identity();
  T_current_last.translation().x() = -0.2;  // the camera has gone right, the block appears 70 px farther left
  const cv::Rect shifted = kBlock - cv::Point(70, 0);
  EXPECT_GT(count_in(kShape, recall(block_at(shifted, 1.5), T_current_last), shifted), cells_in(shifted) * 9 / 10);
}

TEST_F(DynamicMemoryTest, forgets_the_place_once_the_block_has_left) {
  EXPECT_EQ(count_in(kShape, recall(test::wall_image(3.0), Eigen::Isometry3d::Identity()), {0, 0, 640, 480}), 0);
}

TEST_F(DynamicMemoryTest, is_empty_after_clear) {
  memory_.clear();
  EXPECT_EQ(count_in(kShape, recall(block_at(kBlock, 1.5), Eigen::Isometry3d::Identity()), {0, 0, 640, 480}), 0);
}

}  // namespace
}  // namespace rtd::filter
