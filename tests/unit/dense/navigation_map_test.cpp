// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>
#include <set>
#include <sstream>
#include <tuple>

#include "common/geometry/ply.hpp"
#include "services/dense/core/navigation_map.hpp"
#include "services/dense/core/static_map.hpp"
#include "services/dense/dense_service.hpp"
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

const std::vector<CloudPoint> kPoints{{{1, 2, 3}, {10.4F, 20, 30}, 0.5F}, {{-1, 0, 2.5F}, {-4, 255.4F, 300}, 7}};

TEST(Ply, holds_every_point_as_its_header_declares) {
  std::stringstream file;
  write_ply(file, kPoints);
  const std::string text = file.str();
  EXPECT_EQ(geometry::ply_vertices(file), 2U);
  EXPECT_THAT(text, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(text, testing::HasSubstr("property float x\nproperty float y\nproperty float z\nproperty uchar red\n"));
  const std::size_t body = text.find("end_header\n") + 11;
  ASSERT_EQ(text.size() - body, 2U * 19U);
  float x = 0, weight = 0;
  std::memcpy(&x, text.data() + body, 4);
  std::memcpy(&weight, text.data() + body + 15, 4);
  EXPECT_EQ(x, 1.0F);
  EXPECT_EQ(weight, 0.5F);
  EXPECT_EQ(text.substr(body + 12, 3), std::string("\x1e\x14\x0a")) << "red green blue";
  EXPECT_EQ(text.substr(body + 19 + 12, 3), std::string("\xff\xff\x00", 3)) << "clamped";
}

TEST(Ply, header_of_something_else_announces_nothing) {
  for (const char* text : {"", "plx\nelement vertex 3\nend_header\n", "ply\nend_header\nelement vertex 3\n",
                           "ply\nelement vertex -3\nend_header\n", "ply\nelement vertex many\nend_header\n"}) {
    std::istringstream file(text);
    EXPECT_EQ(geometry::ply_vertices(file), std::nullopt) << text;
  }
}

TEST(PointCloud, merges_by_cell_with_weights) {
  const auto merged =
      merge_by_cell({{{0.01F, 0, 0}, {0, 0, 0}, 1}, {{0.05F, 0, 0}, {100, 0, 0}, 3}, {{-0.01F, 0, 0}, {}, 1}}, 0.1);
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_NEAR(merged[0].p_world.x(), 0.04, 1e-6);
  EXPECT_NEAR(merged[0].bgr[0], 75, 1e-4);
  EXPECT_FLOAT_EQ(merged[0].weight, 4);
}

TEST(CloudMessage, has_the_fields_that_viewers_expect) {
  const msg::PointCloud2 cloud = make_cloud(kPoints, 1'500'000'000, "map");
  EXPECT_EQ(cloud.header.frame_id, "map");
  EXPECT_EQ(cloud.width, 2U);
  ASSERT_EQ(cloud.fields.size(), 4U);
  EXPECT_EQ(cloud.fields[3].name, "rgb");
  ASSERT_EQ(cloud.data.size(), 32U);
  EXPECT_THAT(std::vector(cloud.data.begin() + 12, cloud.data.begin() + 16), testing::ElementsAre(10, 20, 30, 0));
}

TEST(MaskMessage, becomes_cells_or_is_refused) {
  msg::Image image;
  image.encoding = "mono8";
  image.width = 2;
  image.height = 2;
  image.step = 3;
  image.data = {1, 2, 9, 3, 4, 9};
  ASSERT_TRUE(from_message(image));
  EXPECT_THAT(from_message(image)->cells, testing::ElementsAre(1, 2, 3, 4));
  const auto broken = [&image](auto change) {
    msg::Image other = image;
    change(other);
    return !from_message(other);
  };
  EXPECT_TRUE(broken([](auto& i) { i.encoding = "bgr8"; }));
  EXPECT_TRUE(broken([](auto& i) { i.data.pop_back(); }));
  EXPECT_TRUE(broken([](auto& i) { i.step = 1; }));
  EXPECT_TRUE(broken([](auto& i) { i.width = 0; }));
  EXPECT_TRUE(broken([](auto& i) { i.width = i.height = 0xffffffff; }));
}

TEST(DynamicMask, grows_and_is_unknown_outside) {
  DynamicMask mask{5, 4, std::vector<std::uint8_t>(20, 0)};
  mask.cells[0] = DynamicMask::kDynamic;
  mask.cells[19] = DynamicMask::kUnknown;
  const DynamicMask wide = grow(mask, 1);
  EXPECT_THAT(wide.cells,
              testing::ElementsAre(255, 255, 0, 0, 0, 255, 255, 0, 0, 0, 0, 0, 0, 128, 128, 0, 0, 0, 128, 128));
  EXPECT_EQ(wide.at(7, 7, 20, 16), DynamicMask::kDynamic);
  EXPECT_EQ(wide.at(8, 0, 20, 16), DynamicMask::kStatic);
  EXPECT_EQ(wide.at(-1, 0, 20, 16), DynamicMask::kUnknown);
  EXPECT_EQ(wide.at(20, 3, 20, 16), DynamicMask::kUnknown);
}

}  // namespace
}  // namespace rtd::dense
