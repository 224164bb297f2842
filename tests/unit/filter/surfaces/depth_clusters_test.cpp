// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/depth_grid.hpp"

#include <gtest/gtest.h>

#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::make_sampler;
using test::put_block;
using test::wall_image;

TEST(DepthClusters, separates_a_block_from_the_wall_behind) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {200, 160, 160, 160}, 1.5);
  const DepthClusters clusters = find_depth_clusters(make_sampler().sample(image), ClusterConfig{});
  ASSERT_EQ(clusters.count(), 2);
  EXPECT_EQ(clusters.cells[1], 40 * 40);
  EXPECT_EQ(clusters.cells[0] + clusters.cells[1], 160 * 120);
}

TEST(DepthClusters, keeps_a_slanted_plane_in_one_piece) {
  vision::RgbdImage image = wall_image();
  for (int v = 0; v < 480; ++v)
    image.depth.row(v).setTo(cv::Scalar((1.0 + 3.0 * (479 - v) / 479) / image.depth_scale_m));
  EXPECT_EQ(find_depth_clusters(make_sampler().sample(image), ClusterConfig{}).count(), 1);
}

TEST(DepthClusters, gives_small_clusters_and_holes_no_number) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {100, 100, 8, 8}, 1.0);
  put_block(image, {300, 100, 80, 80}, 0.0);
  const DepthClusters clusters = find_depth_clusters(make_sampler().sample(image), ClusterConfig{});
  EXPECT_EQ(clusters.count(), 1);
  EXPECT_EQ(clusters.label[static_cast<std::size_t>(clusters.shape.cell_at(104, 104))], -1);
  EXPECT_EQ(clusters.label[static_cast<std::size_t>(clusters.shape.cell_at(340, 140))], -1);
}

TEST(DepthClusters, finds_none_without_depth) {
  vision::RgbdImage image = wall_image();
  image.depth.setTo(0);
  EXPECT_EQ(find_depth_clusters(make_sampler().sample(image), ClusterConfig{}).count(), 0);
}

}  // namespace
}  // namespace rtd::filter
