// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/occupancy/navigation_grid.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace rtd::occupancy {
namespace {

constexpr RobotHeights kHeights;

/// A column of cells with one state at a height above a floor at 0, m.
Volume with(std::initializer_list<std::tuple<int, int, double, Space>> cells) {
  Volume volume;
  for (const auto& [x, y, height_m, space] : cells) {
    volume.cells.set({x, y, static_cast<int>(std::floor(height_m / volume.cell_m))}, space);
  }
  return volume;
}

NavigationGrid plan(const Volume& volume, std::size_t max_cells = 1'000'000) {
  return project(volume, 0, kHeights, max_cells);
}

TEST(GridRotation, takes_up_to_z_and_keeps_x_level) {
  EXPECT_TRUE(grid_rotation(Eigen::Vector3d::UnitZ()).isIdentity(1e-12)) << "a map with z up stays as it is";
  for (const auto& up : {Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0),
                         Eigen::Vector3d(0.2, -3, 0.4), Eigen::Vector3d(0, 0, -1)}) {
    const Eigen::Matrix3d R = grid_rotation(up);
    EXPECT_TRUE((R * up.normalized()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12)) << up.transpose();
    EXPECT_TRUE(R.isUnitary(1e-12));
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
  }
  EXPECT_TRUE((grid_rotation({0, -1, 0}) * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitY(), 1e-12))
      << "a level camera looks along y";
  EXPECT_THROW(grid_rotation({0, 0, std::numeric_limits<double>::infinity()}), std::invalid_argument);
}

TEST(FloorFinder, finds_the_lowest_level_with_many_points) {
  FloorFinder floor;
  EXPECT_FALSE(floor.floor_m(10).has_value());
  for (int i = 0; i < 1000; ++i) {
    floor.add(-0.8 + 0.0001 * (i % 100));  // floor
    floor.add(-0.1 + 0.0001 * (i % 100));  // tables
    floor.add(1.6);
    floor.add(1.6);               // ceiling
    floor.add(-1.5 + 0.003 * i);  // walls, seen deeper through a hole in the floor
  }
  ASSERT_TRUE(floor.floor_m(0.5).has_value());
  EXPECT_NEAR(*floor.floor_m(0.5), -0.795, 0.01) << "m";
  floor.add(std::nan(""));
  floor.add(1e30);
  floor.add(-1e30);
  EXPECT_NEAR(*floor.floor_m(0.5), -0.795, 0.01) << "m";
  EXPECT_FALSE(FloorFinder().floor_m(-1000).has_value());
}

TEST(Project, counts_what_stands_between_the_heights_of_the_robot) {
  const NavigationGrid grid = plan(with({{0, 0, 0.02, Space::kOccupied},
                                         {0, 0, 0.07, Space::kFree},  // floor
                                         {1, 0, 0.50, Space::kOccupied},
                                         {1, 0, 0.12, Space::kFree},  // under a table
                                         {2, 0, 2.00, Space::kOccupied},
                                         {2, 0, 0.12, Space::kFree},  // under a lamp
                                         {3, 0, 0.80, Space::kFree},  // seen above only
                                         {5, 2, 0.15, Space::kFree}}));
  EXPECT_EQ(grid.at({0, 0}), NavigationGrid::kFree);
  EXPECT_EQ(grid.at({1, 0}), NavigationGrid::kOccupied);
  EXPECT_EQ(grid.at({2, 0}), NavigationGrid::kFree);
  EXPECT_EQ(grid.at({3, 0}), NavigationGrid::kUnknown);
  EXPECT_EQ(grid.at({5, 2}), NavigationGrid::kFree);
  EXPECT_EQ(grid.at({-7, 100}), NavigationGrid::kUnknown);
  EXPECT_EQ(grid.columns, 6);
  EXPECT_EQ(grid.rows, 3);
  EXPECT_TRUE(project({}, 0, kHeights, 100).cells.empty());
}

TEST(Project, crops_what_there_is_no_room_for_and_says_so) {
  const Volume volume = with({{-30'000, 0, 0.12, Space::kFree},
                              {0, 0, 0.12, Space::kFree},
                              {30'000, 3, 0.12, Space::kFree},
                              {0, 20'000, 0.12, Space::kOccupied}});
  const NavigationGrid grid = plan(volume, 10'000);
  EXPECT_TRUE(grid.cropped);
  EXPECT_LE(grid.cells.size(), 10'000U);
  EXPECT_FALSE(plan(with({{0, 0, 0.12, Space::kFree}})).cropped);
}

/// The file as map_server and nav2 read it: trinary mode.
std::int8_t read_as_map_server(const YAML::Node& yaml, const std::string& pgm, int x, int y) {
  std::istringstream in(pgm);
  std::string magic, line;
  in >> magic >> std::ws;
  while (in.peek() == '#') std::getline(in, line);
  int columns = 0, rows = 0, most = 0;
  in >> columns >> rows >> most;
  in.get();
  EXPECT_EQ(magic, "P5");
  EXPECT_EQ(most, 255);
  const auto pixels = static_cast<std::size_t>(in.tellg());
  EXPECT_EQ(pgm.size() - pixels, static_cast<std::size_t>(columns * rows));
  const auto value = static_cast<std::uint8_t>(pgm[pixels + static_cast<std::size_t>((rows - 1 - y) * columns + x)]);
  const double occupied = yaml["negate"].as<int>() != 0 ? value / 255.0 : (255 - value) / 255.0;
  if (occupied > yaml["occupied_thresh"].as<double>()) return NavigationGrid::kOccupied;
  return occupied < yaml["free_thresh"].as<double>() ? NavigationGrid::kFree : NavigationGrid::kUnknown;
}

TEST(MapFiles, are_read_by_the_rules_of_map_server) {
  const NavigationGrid grid = plan(with({{-4, -2, 0.5, Space::kOccupied},
                                         {-3, -2, 0.12, Space::kFree},
                                         {2, 5, 0.12, Space::kFree},
                                         {1, 3, 0.9, Space::kOccupied}}));
  std::ostringstream pgm;
  write_pgm(pgm, grid);
  const YAML::Node yaml = YAML::Load(map_yaml(grid, "map.pgm"));
  EXPECT_EQ(yaml["image"].as<std::string>(), "map.pgm");
  EXPECT_DOUBLE_EQ(yaml["resolution"].as<double>(), 0.05);
  EXPECT_NEAR(yaml["origin"][0].as<double>(), -0.2, 1e-9) << "m";
  EXPECT_NEAR(yaml["origin"][1].as<double>(), -0.1, 1e-9) << "m";
  EXPECT_EQ(yaml["origin"].size(), 3U);
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      EXPECT_EQ(read_as_map_server(yaml, pgm.str(), x, y), grid.at(grid.first + Eigen::Vector2i(x, y)));
    }
  }
}

}  // namespace
}  // namespace rtd::occupancy
