// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "services/filter/core/surfaces/depth_grid.hpp"
#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::make_sampler;
using test::put_block;
using test::wall_image;

TEST(DepthGrid, has_the_depth_of_a_plane_in_every_cell) {
  const DepthGrid grid = make_sampler().sample(wall_image(2.5));
  EXPECT_EQ(grid.shape.columns, 160);
  EXPECT_EQ(grid.shape.rows, 120);
  for (std::size_t cell = 0; cell < grid.depth_m.size(); ++cell) {
    EXPECT_NEAR(grid.depth_m[cell], 2.5, 1e-4);
    EXPECT_NEAR(grid.far_m[cell], grid.near_m[cell], 1e-4);
  }
}

TEST(DepthGrid, has_near_and_far_depth_along_an_edge) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, {320, 0, 320, 480}, 1.0);
  const DepthGrid grid = make_sampler().sample(image);
  const auto beside = static_cast<std::size_t>(grid.shape.cell_at(317, 240));  // the last cell of the wall
  EXPECT_NEAR(grid.depth_m[beside], 3.0, 1e-3);
  EXPECT_NEAR(grid.near_m[beside], 1.0, 1e-3);
  EXPECT_NEAR(grid.far_m[beside], 3.0, 1e-3);
}

TEST(DepthGrid, measures_nothing_in_zero_near_or_saturated_depth) {
  for (const int raw : {0, 500, 65535}) {
    vision::RgbdImage image = wall_image();
    image.depth.setTo(raw);
    const DepthGrid grid = make_sampler().sample(image);
    EXPECT_EQ(*std::max_element(grid.depth_m.begin(), grid.depth_m.end()), 0.0F) << "raw depth " << raw;
    EXPECT_EQ(*std::max_element(grid.near_m.begin(), grid.near_m.end()), 0.0F) << "raw depth " << raw;
  }
}

TEST(DepthGrid, takes_the_raw_pixel_of_an_undistorted_cell) {
  vision::RgbdImage image = wall_image(3.0);
  geometry::CameraModel::Parameters p = test::pinhole().parameters();
  p.distortion = {0.26, -0.95, -0.005, 0.0026, 1.16};
  image.camera = geometry::CameraModel(p);
  const cv::Rect raw_patch(560, 60, 20, 20);
  put_block(image, raw_patch, 1.0);
  const DepthGrid grid = make_sampler().sample(image);
  const Eigen::Vector2d undistorted = image.camera.undistort({570, 70});
  EXPECT_GT((undistorted - Eigen::Vector2d(570, 70)).norm(), 2.0) << "px: otherwise this tests nothing";
  EXPECT_NEAR(grid.depth_m[static_cast<std::size_t>(grid.shape.cell_at(undistorted.x(), undistorted.y()))], 1.0, 1e-3);
}

TEST(GridShape, has_no_cell_for_a_position_outside) {
  const GridShape shape{160, 120};
  EXPECT_EQ(shape.cell_at(-0.1, 5), -1);
  EXPECT_EQ(shape.cell_at(640, 5), -1);
  EXPECT_EQ(shape.cell_at(std::numeric_limits<double>::quiet_NaN(), 5), -1);
  EXPECT_EQ(shape.nearest_cell(-50, 1000), shape.index(0, 119));
}

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
