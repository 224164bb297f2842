// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/navigation_map.hpp"

#include <gmock/gmock.h>

#include <set>
#include <tuple>

#include "tests/unit/dense/wall_scene.hpp"

namespace rtd::dense {
namespace {

using test::at_origin;
using test::keyframe;
using test::WallScene;

const cv::Rect kBlock{60, 30, 40, 90};  // down to the floor

/// The camera looks along y of `grid`, 1 m above the floor.
NavigationConfig config() {
  NavigationConfig config;
  config.find_floor = false;
  config.floor_m = -1;
  config.heights.clear_below_m = 1.0;  // the small camera does not see the floor near it
  return config;
}

/// Both maps as rtd-dense keeps them.
struct Maps {
  explicit Maps(const NavigationConfig& of_navigation = config())
      : navigation(of_navigation, -Eigen::Vector3d::UnitY()) {}
  void integrate(const vision::RgbdImage& image, const DynamicMask& mask = all_static(),
                 const Eigen::Isometry3d& T_map_camera = at_origin()) {
    ASSERT_EQ(occupied.integrate(image, mask, T_map_camera).outcome, FusionReport::Outcome::kFused);
    navigation.integrate(image, T_map_camera);
  }
  void update(const msg::KeyframeEvent& event) {
    occupied.update(event);
    navigation.update(event);
  }
  NavigationGrid grid() {
    navigation.follow_corrections();
    return navigation.grid(occupied).value();
  }
  StaticMap occupied{WallScene::config()};
  NavigationMap navigation;
};

/// What the plan says of a place, m.
std::int8_t at(const NavigationGrid& grid, double x_m, double y_m) {
  return grid.at({static_cast<int>(std::floor(x_m / grid.cell_m)), static_cast<int>(std::floor(y_m / grid.cell_m))});
}

std::set<std::tuple<int, int, int>> free_cells(const NavigationMap& map) {
  std::set<std::tuple<int, int, int>> cells;
  map.space().for_each(1, [&](const Eigen::Vector3i& cell) { cells.emplace(cell.x(), cell.y(), cell.z()); });
  return cells;
}

/// Leftmost and rightmost occupied column, cells of `grid`.
std::pair<int, int> wall_ends(const NavigationGrid& grid) {
  std::pair<int, int> ends{1 << 20, -(1 << 20)};
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2i cell = grid.first + Eigen::Vector2i(column, row);
      if (grid.at(cell) != NavigationGrid::kOccupied) continue;
      ends = {std::min(ends.first, cell.x()), std::max(ends.second, cell.x())};
    }
  }
  return ends;
}

class NavigationMapTest : public testing::Test {
 protected:
  WallScene scene;
  Maps maps;
};

TEST_F(NavigationMapTest, has_the_wall_and_the_free_way_to_it) {
  for (int i = 0; i < 4; ++i) maps.integrate(scene.render({}, 3.025));
  const NavigationGrid grid = maps.grid();
  EXPECT_EQ(at(grid, 0.3, WallScene::kWallM), NavigationGrid::kOccupied);
  EXPECT_EQ(at(grid, 0, 1.0), NavigationGrid::kFree);
  EXPECT_EQ(at(grid, 0, 2.5), NavigationGrid::kFree);
  EXPECT_EQ(at(grid, 0, 3.5), NavigationGrid::kUnknown);
  EXPECT_EQ(at(grid, 2.5, 1.0), NavigationGrid::kUnknown) << "beside the view";
  const auto ends = wall_ends(grid);
  EXPECT_LT(static_cast<double>(std::ranges::count(grid.cells, NavigationGrid::kOccupied)),
            1.1 * (ends.second - ends.first + 1))
      << "one cell thick";
}

TEST_F(NavigationMapTest, readings_on_what_moves_clear_what_is_before_it_and_nothing_behind) {
  for (int i = 0; i < 4; ++i) maps.integrate(scene.render(kBlock), WallScene::mask(kBlock));
  const NavigationGrid grid = maps.grid();
  EXPECT_EQ(at(grid, 0, 1.0), NavigationGrid::kFree);
  EXPECT_EQ(at(grid, 0, WallScene::kBlockM), NavigationGrid::kUnknown) << "neither free nor an obstacle";
  EXPECT_EQ(at(grid, 0, 2.5), NavigationGrid::kUnknown) << "hidden by the person";
  EXPECT_EQ(at(grid, 0.9, 2.5), NavigationGrid::kFree) << "beside the person";
}

TEST_F(NavigationMapTest, a_person_that_no_mask_named_leaves_nothing_once_seen_through) {
  for (int i = 0; i < 6; ++i) maps.integrate(scene.render(kBlock));
  EXPECT_EQ(at(maps.grid(), 0, WallScene::kBlockM), NavigationGrid::kOccupied);
  for (int i = 1; i <= 12; ++i) {  // a known view is renewed once a second
    vision::RgbdImage image = scene.render();
    image.stamp_ns += i * std::int64_t{1'000'000'000};
    maps.integrate(image);
  }
  const NavigationGrid grid = maps.grid();
  EXPECT_EQ(at(grid, 0, WallScene::kBlockM), NavigationGrid::kFree);
  EXPECT_EQ(at(grid, 0, 2.5), NavigationGrid::kFree);
}

TEST(NavigationMap, moves_with_the_keyframes_that_slam_corrects) {
  WallScene scene(0);
  Maps maps;
  maps.update(keyframe(0, 0));
  for (int i = 0; i < 4; ++i) maps.integrate(scene.render());
  const auto before = wall_ends(maps.grid());
  const auto free_before = free_cells(maps.navigation);
  maps.update(keyframe(1, 0));
  maps.update(keyframe(0, 0.5, msg::KeyframeEventKind::kCorrected));
  const NavigationGrid moved = maps.grid();
  EXPECT_NEAR(wall_ends(moved).first, before.first + 10, 1) << "cells";
  EXPECT_NEAR(wall_ends(moved).second, before.second + 10, 1) << "cells";
  EXPECT_EQ(at(moved, 0.5, 2.5), NavigationGrid::kFree);
  EXPECT_EQ(maps.navigation.space().moved_scans(), 2U);
  maps.update(keyframe(0, 0, msg::KeyframeEventKind::kRemoved));  // keyframe 1 takes over
  maps.update(keyframe(1, -0.5, msg::KeyframeEventKind::kCorrected));
  EXPECT_NEAR(wall_ends(maps.grid()).first, before.first, 1) << "cells";
  EXPECT_EQ(free_cells(maps.navigation), free_before) << "subtracted exactly where it was added";
}

TEST(NavigationMap, follows_a_correction_in_small_steps_and_ignores_small_ones) {
  WallScene scene(0);
  Maps maps;
  maps.update(keyframe(0, 0));
  for (int i = 0; i < 12; ++i) {
    Eigen::Isometry3d T_map_camera = at_origin();
    T_map_camera.translation().x() = 0.3 * i;  // other viewpoints
    maps.integrate(scene.render(), all_static(), T_map_camera);
  }
  maps.update(keyframe(0, 0.01, msg::KeyframeEventKind::kCorrected));
  EXPECT_TRUE(maps.navigation.follow_corrections(0)) << "less than half a cell";
  maps.update(keyframe(0, 1, msg::KeyframeEventKind::kCorrected));
  int steps = 1;
  while (!maps.navigation.follow_corrections(4)) ++steps;
  EXPECT_EQ(steps, 3);
  EXPECT_EQ(maps.navigation.space().moved_scans(), 12U);
}

TEST_F(NavigationMapTest, keeps_few_images_of_a_view_that_does_not_change) {
  for (int i = 0; i < 60; ++i) maps.navigation.integrate(scene.render(), at_origin());
  EXPECT_EQ(maps.navigation.space().scans(), 2U);
}

TEST(NavigationMap, stays_within_its_memory_and_says_so) {
  WallScene scene;
  NavigationConfig small = config();
  small.space.max_blocks = 10;
  Maps few_blocks(small);
  for (int i = 0; i < 3; ++i) few_blocks.integrate(scene.render());
  EXPECT_TRUE(few_blocks.navigation.space().full());
  EXPECT_EQ(at(few_blocks.grid(), 0.3, WallScene::kWallM), NavigationGrid::kOccupied) << "obstacles stay";
  small = config();
  small.space.max_scans = 10;
  Maps few_scans(small);
  for (int i = 0; i < 12; ++i) {
    Eigen::Isometry3d T_map_camera = at_origin();
    T_map_camera.translation().x() = 0.3 * i;
    few_scans.integrate(scene.render(), all_static(), T_map_camera);
  }
  EXPECT_TRUE(few_scans.navigation.space().full());
  EXPECT_EQ(few_scans.navigation.space().scans(), 10U);
}

TEST_F(NavigationMapTest, begins_again_when_it_is_cleared) {
  for (int i = 0; i < 3; ++i) maps.integrate(scene.render());
  maps.navigation.clear();
  maps.occupied.clear();
  EXPECT_TRUE(maps.grid().cells.empty());
  EXPECT_TRUE(free_cells(maps.navigation).empty());
}

TEST_F(NavigationMapTest, takes_depth_of_nothing_and_refuses_an_up_without_direction) {
  vision::RgbdImage image = scene.render();
  image.depth.setTo(0);
  for (int i = 0; i < 3; ++i) maps.integrate(image);
  EXPECT_TRUE(free_cells(maps.navigation).empty());
  EXPECT_THROW(NavigationMap(config(), Eigen::Vector3d::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace rtd::dense
